// Stores among themselves and with the world, as a user would: import, export, merge, diff,
// explain.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "renderer/image/image.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kExperiment = R"(name: tiny
scenes: [CornellBox]
image: {width: 16, height: 12}
methods:
  nee: {method: path, max_depth: 3, bsdf: false}
  mis: {method: path, max_depth: 3}
seeds: 4
budgets: [{samples: 2}]
reference: {method: mis, samples: 32}
)";

class StoresTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        folder_->write("tiny.yaml", kExperiment);
        EXPECT_EQ(run("store").exit_code, 0);
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static std::string file(const std::string& name) { return (folder_->path() / name).string(); }

    static Outcome misbench(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, folder_->path()).wait();
    }
    static Outcome run(const std::string& store, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"run", file("tiny.yaml"), "--store", file(store)};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return misbench(arguments);
    }
    static std::string result_of(const std::vector<std::string>& arguments) {
        const Outcome outcome = misbench(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    }
    static std::string table(const std::string& store) {
        return result_of({"table", file(store), "--experiment", "tiny", "--format", "csv"});
    }
    static void copy_store(const std::string& to) {
        fs::remove_all(file(to));
        fs::copy(file("store"), file(to), fs::copy_options::recursive);
    }
    static void expect_error(const Outcome& outcome, int exit_code, const std::string& message) {
        EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    }

    inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(StoresTest, ExportedImagesMakeTheSameTableElsewhere) {
    EXPECT_THAT(result_of({"export", file("store"), "--images", file("images")}),
                StartsWith("15 images of experiment 'tiny'"));
    EXPECT_TRUE(fs::exists(file("images/CornellBox/mis/2_spp/seed3.exr")));
    EXPECT_TRUE(fs::exists(file("images/CornellBox/mis/2_spp/mean.exr")));
    EXPECT_TRUE(fs::exists(file("images/CornellBox/mis/2_spp/standard_error.exr")));
    EXPECT_THAT(result_of({"import", file("elsewhere"), "--experiment", "tiny", "--list",
                           file("images/images.csv")}),
                StartsWith("10 imported, 0 there before, 8 errors measured"));
    EXPECT_EQ(table("elsewhere"), table("store"));
    result_of({"export", file("elsewhere"), "--images", file("back")});
    EXPECT_THAT(result_of({"import", file("elsewhere"), "--experiment", "tiny", "--list",
                           file("back/images.csv")}),
                StartsWith("0 imported, 10 there before"));
    expect_error(misbench({"export", file("store"), "--images", file("images")}), 2, "not empty");
    result_of(
        {"export", file("store"), "--images", file("pngs"), "--format", "png", "--what", "means"});
    EXPECT_TRUE(fs::exists(file("pngs/CornellBox/nee/2_spp/mean.png")));
}

TEST_F(StoresTest, ExportedSnapshotsMakeTheSameCurveElsewhere) {
    const std::vector<std::string> with{"--set", "snapshots=2", "--set",
                                        "budgets=[{samples: 4}, {samples: 16}]"};
    ASSERT_EQ(run("curve", with).exit_code, 0);
    // 2 + 4 seeds × 2 methods × 2 budgets, 7 means; 2 and 4 snapshots of a run.
    EXPECT_THAT(
        result_of({"export", file("curve"), "--images", file("curve-images"), "--what", "runs"}),
        StartsWith("64 images of experiment 'tiny'"));
    EXPECT_TRUE(fs::exists(file("curve-images/CornellBox/mis/16_spp/seed3.snapshot-000008.exr")));
    result_of({"export", file("curve"), "--images", file("curve-halves"), "--what", "references"});
    for (const std::string list :
         {"curve-images/images.csv", "curve-images/snapshots.csv", "curve-halves/images.csv"}) {
        result_of(
            {"import", file("curve-elsewhere"), "--experiment", "tiny", "--list", file(list)});
    }
    const auto curve = [](const std::string& store) {
        const auto json =
            nlohmann::json::parse(result_of({"tradeoff", file(store), "--experiment", "tiny", "--x",
                                             "passes", "--format", "json"}));
        std::map<std::pair<std::string, double>, double> errors;
        for (const auto& point : json.at("points")) {
            errors[{point.at("method"), point.at("passes")}] = point.at("error");
        }
        return errors;
    };
    EXPECT_EQ(curve("curve").size(), 2U * 5U) << "after 1, 2, 4, 8 and 16 samples";
    EXPECT_EQ(curve("curve-elsewhere"), curve("curve"));
}

TEST_F(StoresTest, ImportedMethodsStandBesideRenderedOnesAndStayThere) {
    copy_store("both");
    fs::create_directories(file("own/CornellBox"));
    for (const std::string seed : {"1", "2", "3", "4"}) {
        result_of({"render", "CornellBox", "--method", "bdpt", "--spp", "2", "--size", "16x12",
                   "--seed", seed, "-o", file("own/CornellBox/mine-" + seed + ".exr")});
    }
    EXPECT_THAT(result_of({"import", file("both"), "--experiment", "tiny", "--pattern",
                           "{scene}/{method}-{seed}.exr", file("own"), "--samples", "2",
                           "--renderer", "Own 1.0"}),
                StartsWith("4 imported, 0 there before, 4 errors measured"));
    const std::string with = table("both");
    EXPECT_THAT(with, HasSubstr("mine"));
    const Outcome again = run("both", {"--set", "seeds=5"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.out, AllOf(HasSubstr("mine"), HasSubstr("renderer: Own 1.0: 4 runs")));
    result_of({"report", file("both"), "--experiment", "tiny"});
    expect_error(
        misbench({"import", file("both"), "--experiment", "tiny", "--scene", "CornellBox",
                  "--method", "mine", "--samples", "2", file("own/CornellBox/mine-2.exr")}),
        2, "--replace");
}

TEST_F(StoresTest, WhatIsRemovedIsAllThatIsMissing) {
    copy_store("with");
    const std::string before = table("with");
    fs::create_directories(file("more"));
    result_of({"render", "CornellBox", "--method", "bdpt", "--spp", "2", "--size", "16x12", "-o",
               file("more/theirs-1.exr")});
    const std::vector<std::string> import{
        "import",    file("with"),          "--experiment", "tiny",      "--scene", "CornellBox",
        "--pattern", "{method}-{seed}.exr", file("more"),   "--samples", "2"};
    EXPECT_THAT(result_of(import), StartsWith("1 imported"));
    EXPECT_NE(table("with"), before);
    EXPECT_EQ(
        result_of({"import", file("with"), "--experiment", "tiny", "--remove", "theirs"}),
        "1 image of 'theirs' removed from experiment 'tiny' of store '" + file("with") + "'\n");
    EXPECT_EQ(table("with"), before);
    EXPECT_EQ(misbench({"diff", file("store"), file("with")}).exit_code, 0);
    EXPECT_THAT(result_of(import), StartsWith("0 imported, 1 there before"));
    expect_error(misbench({"import", file("with"), "--experiment", "tiny", "--remove", "mis"}), 2,
                 "one that misbench renders");
    expect_error(misbench({"import", file("with"), "--experiment", "tiny", "--remove", "theirs",
                           file("more/theirs-1.exr")}),
                 2, "--remove");
}

TEST_F(StoresTest, DiffNamesTheSceneFileThatHasChanged) {
    fs::create_directories(file("scenes"));
    fs::copy(fs::path(MISBENCH_SCENES) / "CornellBox", file("scenes/CornellBox"),
             fs::copy_options::recursive);
    const auto run_own = [](const std::string& store) {
        return run(store, {"--scenes", file("scenes"), "--set", "seeds=[1, 2]"});
    };
    ASSERT_EQ(run_own("unchanged").exit_code, 0);
    fs::path scene;
    for (const auto& entry : fs::recursive_directory_iterator(file("scenes"))) {
        if (entry.path().extension() == ".json") scene = entry.path();
    }
    std::ofstream(scene, std::ios::app) << " ";
    ASSERT_EQ(run_own("changed").exit_code, 0);
    const Outcome diff = misbench({"diff", file("unchanged"), file("changed")});
    EXPECT_EQ(diff.exit_code, 1) << diff.err;
    EXPECT_THAT(diff.out, HasSubstr("scene content of " + scene.string() + " ("));
}

TEST_F(StoresTest, DiffTellsByItsExitCode) {
    copy_store("same");
    const Outcome same = misbench({"diff", file("store"), file("same")});
    EXPECT_EQ(same.exit_code, 0) << same.err;
    EXPECT_THAT(same.out, AllOf(HasSubstr("10 images are the same"), HasSubstr("no differences")));
    ASSERT_EQ(run("same", {"--set", "methods.mis.max_depth=5"}).exit_code, 0);
    const Outcome other = misbench({"diff", file("store"), file("same")});
    EXPECT_EQ(other.exit_code, 1) << other.err;
    EXPECT_THAT(other.out,
                AllOf(HasSubstr("other task: tiny: CornellBox, mis, 2 spp, seeds 1 2 3 4: "
                                "parameter max_depth 3, not 5"),
                      HasSubstr("the stores differ")));
    const auto json =
        nlohmann::json::parse(misbench({"diff", file("store"), file("same"), "--json"}).out);
    EXPECT_EQ(json.at("same"), false);
    EXPECT_EQ(json.at("other_tasks").size(), 3);
    expect_error(misbench({"diff", file("store"), file("none")}), 2, "no results.sqlite");
}

TEST_F(StoresTest, MergeOfPartsIsTheWhole) {
    ASSERT_EQ(run("low", {"--set", "seeds=[1, 2]"}).exit_code, 0);
    ASSERT_EQ(run("high", {"--set", "seeds=[3, 4]"}).exit_code, 0);
    EXPECT_THAT(result_of({"merge", file("merged"), file("low"), file("high")}),
                StartsWith("10 runs copied, 2 there before, 8 errors measured; experiments that "
                           "came or grew: tiny"));
    EXPECT_EQ(misbench({"diff", file("store"), file("merged")}).exit_code, 0);
}

TEST_F(StoresTest, ExplainSaysWhatIsReusedAndWhyNot) {
    const std::string all =
        result_of({"explain", file("store"), "--experiment", file("tiny.yaml")});
    EXPECT_THAT(all,
                AllOf(HasSubstr("CornellBox, mis, 2 spp, seeds 1 2 3 4\n  in the store: reused"),
                      HasSubstr("tiny: 10 of 10 tasks are in the store")));
    const std::string deeper =
        result_of({"explain", file("store"), "--experiment", file("tiny.yaml"), "--set",
                   "methods.nee.max_depth=5", "--method", "nee"});
    EXPECT_THAT(
        deeper,
        AllOf(HasSubstr("the nearest run differs: parameter max_depth 5, not 3; no task yet; "
                        "such as run "),
              HasSubstr("0 of 4 tasks"), Not(HasSubstr("mis,"))));
    const std::string more = result_of({"explain", file("store"), "--experiment", file("tiny.yaml"),
                                        "--set", "seeds=6", "--method", "nee"});
    EXPECT_THAT(more, HasSubstr("seeds 5 6\n  not in the store: this seed has no run"));

    const auto tasks = nlohmann::json::parse(
        result_of({"plan", file("tiny.yaml"), "--store", file("store"), "--json"}));
    const std::string id = tasks.at("list").at(2).at("id");
    const std::string run = result_of({"explain", file("store"), id.substr(0, 10)});
    EXPECT_THAT(run, AllOf(HasSubstr("run " + id), HasSubstr("parameter max_depth"),
                           HasSubstr("experiment 'tiny': CornellBox, nee, 2 spp, seed 1")));
    expect_error(misbench({"explain", file("store"), "zz"}), 2, "unknown run 'zz'");
    expect_error(misbench({"explain", file("store")}), 2, "either a run or --experiment");
}

}  // namespace
}  // namespace misbench
