// The layers, who owns which third-party header, how long a file may be, what lies on the top
// level: rules of the project that a compiler does not check.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "renderer/base/files.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
const fs::path kSource = MISBENCH_SOURCE;

// A layer is a folder; the longest one that a path begins with is its layer.
struct Layer {
    std::string folder;
    std::set<std::string> may_include;  // besides itself
};

const std::vector<Layer> kLayers = {
    {"renderer/base", {}},
    {"renderer/image", {"renderer/base"}},
    {"renderer", {"renderer/base", "renderer/image"}},
    {"experiments/plan", {"renderer/base"}},
    {"results", {"renderer/base", "renderer/image", "experiments/plan"}},
    {"proto", {"renderer/base", "experiments/plan"}},
    {"coordinator", {"renderer/base", "experiments/plan", "results", "proto"}},
    {"worker",
     {"renderer/base", "renderer/image", "renderer", "experiments/plan", "results", "proto"}},
    {"experiments/statistics", {"renderer/base"}},
    {"experiments/analysis",
     {"renderer/base", "renderer/image", "experiments/plan", "experiments/statistics", "results"}},
    {"experiments",
     {"renderer/base", "renderer/image", "renderer", "experiments/plan", "experiments/statistics",
      "experiments/analysis", "results", "proto"}},
    {"tests", {}},  // may include everything; nothing includes tests
};

// Third-party headers and the folders whose files may include them.
struct Owner {
    std::string header_prefix;
    std::vector<std::string> folders;
};
const std::vector<Owner> kOwners = {
    {"embree3/", {"renderer/embree"}},
    {"Imf", {"renderer/image"}},
    {"half.h", {"experiments/report"}},
    {"png.h", {"renderer/image"}},
    {"stb/", {"renderer/image"}},
    {"openssl/", {"renderer/base"}},
    {"Random123/", {"renderer/base"}},
    {"sqlite3.h", {"results"}},
    {"pugixml", {"renderer/scene/mitsuba"}},
    {"zlib.h", {"renderer/scene", "experiments/report"}},
    {"yaml-cpp/", {"experiments/plan"}},
    {"boost/", {"experiments/statistics", "experiments/lab"}},
    {"Eigen/", {"renderer/mis"}},
    {"cairo", {"experiments/figure"}},
    {"pango", {"experiments/figure"}},
    {"CLI/", {"experiments/cli", "coordinator", "worker"}},
    {"grpc", {"proto", "coordinator/rpc", "worker/rpc"}},
    {"google/protobuf", {"proto"}},
    {"proto/queue.pb.h", {"proto", "coordinator/rpc", "worker/rpc"}},
    {"proto/queue.grpc.pb.h", {"proto", "coordinator/rpc", "worker/rpc"}},
};

constexpr int kMaxLines = 600;

bool is_below(const std::string& path, const std::string& folder) {
    return path.starts_with(folder + "/");
}

std::vector<std::string> source_files() {
    std::vector<std::string> files;
    for (const char* top :
         {"renderer", "experiments", "results", "proto", "coordinator", "worker", "tests"}) {
        for (const auto& entry : fs::recursive_directory_iterator(kSource / top)) {
            const auto extension = entry.path().extension();
            if (extension == ".h" || extension == ".cpp") {
                files.push_back(fs::relative(entry.path(), kSource).generic_string());
            }
        }
    }
    return files;
}

std::vector<std::string> includes_of(const std::string& text) {
    std::vector<std::string> includes;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("#include")) continue;
        const std::size_t open = line.find_first_of("<\"");
        includes.push_back(line.substr(open + 1, line.find_first_of(">\"", open + 1) - open - 1));
    }
    return includes;
}

const Layer* layer_of(const std::string& path) {
    const Layer* found = nullptr;
    for (const Layer& layer : kLayers) {
        if (is_below(path, layer.folder) &&
            (found == nullptr || layer.folder.size() > found->folder.size())) {
            found = &layer;
        }
    }
    return found;
}

// What is wrong with one include, "" if nothing.
std::string complaint(const std::string& file, const std::string& include) {
    for (const Owner& owner : kOwners) {
        if (!include.starts_with(owner.header_prefix)) continue;
        const bool allowed =
            std::any_of(owner.folders.begin(), owner.folders.end(),
                        [&file](const std::string& folder) { return is_below(file, folder); });
        return allowed || is_below(file, "tests") ? "" : file + " includes " + include;
    }
    const Layer* from = layer_of(file);
    const Layer* to = layer_of(include);
    if (to == nullptr || from == to || from->folder == "tests") return "";
    return from->may_include.contains(to->folder) ? "" : file + " includes " + include;
}

TEST(Architecture, EveryFileIncludesItsOwnLayerOrOneItMayUse) {
    std::vector<std::string> complaints;
    for (const std::string& file : source_files()) {
        for (const std::string& include : includes_of(read_file(kSource / file))) {
            const std::string text = complaint(file, include);
            if (!text.empty()) complaints.push_back(text);
        }
    }
    EXPECT_THAT(complaints, testing::IsEmpty());
}

TEST(Architecture, NoticesAForbiddenInclude) {
    EXPECT_NE(complaint("coordinator/lease_table.h", "worker/session.h"), "");
    EXPECT_NE(complaint("coordinator/lease_table.h", "renderer/scene/scene.h"), "");
    EXPECT_NE(complaint("results/store.h", "sqlite3.h") + complaint("worker/x.h", "sqlite3.h"), "");
    EXPECT_NE(complaint("worker/session.cpp", "proto/queue.pb.h"), "");
    EXPECT_NE(complaint("renderer/methods/path.cpp", "tests/support/scenes.h"), "");
    EXPECT_EQ(complaint("worker/session.cpp", "renderer/scene/load.h"), "");
}

TEST(Architecture, NoFileIsLongerThanTheLimit) {
    for (const std::string& file : source_files()) {
        const std::string text = read_file(kSource / file);
        EXPECT_LE(std::count(text.begin(), text.end(), '\n'), kMaxLines) << file;
    }
}

TEST(Architecture, TheTopLevelHoldsWhatItShould) {
    const std::set<std::string> expected = {
        "CMakeLists.txt", "CMakePresets.json", "LICENSE",     "README.md", "proto", "worker",
        "coordinator",    "renderer",          "experiments", "results",   "tests"};
    // Builds and stores, which git ignores.
    const auto ignored = [](const std::string& name) {
        return name.starts_with(".") || name == "build" || name.ends_with("-store");
    };
    for (const auto& entry : fs::directory_iterator(kSource)) {
        const std::string name = entry.path().filename();
        EXPECT_TRUE(expected.contains(name) || ignored(name)) << name;
    }
    for (const std::string& name : expected) EXPECT_TRUE(fs::exists(kSource / name)) << name;
}

}  // namespace
}  // namespace misbench
