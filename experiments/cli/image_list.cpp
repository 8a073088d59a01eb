#include "experiments/cli/image_list.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "experiments/plan/budget_entry.h"
#include "experiments/plan/imported.h"
#include "experiments/plan/suggestion.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPath = "path";
const std::vector<std::string> kFields = {"scene",       "method",       "seed",    "samples",
                                          "seconds",     "clock",        "budget",  "passes",
                                          "cpu_seconds", "wall_seconds", "renderer"};
const std::vector<std::string> kImageExtensions = {".exr", ".pfm", ".hdr", ".png", ".jpg"};

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
    throw Error(Errc::InvalidArgument, "import '" + file.string() + "': " + what);
}

// One image's fields, each read as what it is.
struct FieldReader {
    const fs::path& file;
    const Fields& fields;

    std::string text(const std::string& name) const {
        const auto found = fields.find(name);
        return found == fields.end() ? "" : found->second;
    }

    template <class T>
    std::optional<T> number(const std::string& name, T least, T most) const {
        const std::string value = text(name);
        if (value.empty()) return std::nullopt;
        T number{};
        const auto [stop, error] =
            std::from_chars(value.data(), value.data() + value.size(), number);
        const bool is_whole = error == std::errc{} && stop == value.data() + value.size();
        if (!is_whole || !(number >= least) || !(number <= most)) {
            fail(file, name + " is '" + value + "': must be a number from " +
                           to_string(ParameterValue(least)) + " to " +
                           to_string(ParameterValue(most)));
        }
        return number;
    }

    std::optional<double> seconds(const std::string& name) const {
        return number(name, 1e-9, kMaxBudgetSeconds);
    }
};

// What is said of all images, where it is not said of one itself. Of a reference's half only which
// scene it is of and who rendered it: it has not the budget of what is compared with it.
void add_given(Fields& fields, const Fields& given) {
    for (const auto& [name, value] : given) {
        const auto method = fields.find("method");
        const bool is_reference = method != fields.end() && method->second == kReferenceLabel;
        if (!is_reference || name == "scene" || name == "renderer") fields.emplace(name, value);
    }
}

std::vector<fs::path> files_below(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> files;
    for (auto it = fs::recursive_directory_iterator(folder, error);
         !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
        if (it->is_regular_file()) files.push_back(it->path());
    }
    if (error) {
        throw Error(Errc::NotFound, "import '" + folder.string() + "': " + error.message());
    }
    std::ranges::sort(files);
    return files;
}

// RFC 4180: commas, lines, quotes around what has any of them, doubled quotes within.
std::vector<std::vector<std::string>> parse_csv(const fs::path& file, const std::string& text) {
    std::vector<std::vector<std::string>> rows{{""}};
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        std::string& field = rows.back().back();
        if (is_quoted) {
            if (c != '"') {
                field += c;
            } else if (i + 1 < text.size() && text[i + 1] == '"') {
                field += text[++i];
            } else {
                is_quoted = false;
            }
        } else if (c == '"' && field.empty()) {
            is_quoted = true;
        } else if (c == ',') {
            rows.back().emplace_back();
        } else if (c == '\n') {
            rows.push_back({""});
        } else if (c != '\r') {
            field += c;
        }
    }
    if (is_quoted) fail(file, "a quote is not closed");
    std::erase_if(rows, [](const auto& row) { return row.size() == 1 && row[0].empty(); });
    return rows;
}

}  // namespace

ImageToImport image_of(const fs::path& file, const Fields& fields) {
    const FieldReader read{file, fields};
    ImageToImport image{.file = file,
                        .scene = read.text("scene"),
                        .method = read.text("method"),
                        .seed = read.number<std::int64_t>("seed", 0, INT64_MAX).value_or(1),
                        .passes = read.number<std::int64_t>("passes", 1, kMaxSamples),
                        .cpu_seconds = read.seconds("cpu_seconds"),
                        .wall_seconds = read.seconds("wall_seconds"),
                        .renderer = read.text("renderer")};
    const auto samples = read.number<std::int64_t>("samples", 1, kMaxSamples);
    const auto seconds = read.seconds("seconds");
    const std::string clock = read.text("clock");
    if (!clock.empty() && clock != "cpu" && clock != "wall") {
        fail(file, unknown_name("clock", clock, {"cpu", "wall"}));
    }
    if (samples) image.passes = samples;
    if (seconds) (clock == "wall" ? image.wall_seconds : image.cpu_seconds) = seconds;
    if (const std::string budget = read.text("budget"); !budget.empty()) {
        const bool is_unknown = image.method == kReferenceLabel && budget == "0 spp";
        if (!is_unknown) image.budget = budget_from_string(budget);
    } else if (samples) {
        image.budget = SampleBudget{*samples};
    } else if (seconds) {
        image.budget = TimeBudget{*seconds, clock == "wall" ? BudgetClock::Wall : BudgetClock::Cpu};
    }
    return image;
}

std::vector<ImageToImport> images_below(const fs::path& folder, const std::string& pattern,
                                        const Fields& given,
                                        std::vector<std::string>& passed_over) {
    const PathPattern path_pattern(pattern, kFields);
    std::vector<ImageToImport> images;
    std::string example;
    for (const fs::path& file : files_below(folder)) {
        const std::string path = file.lexically_relative(folder).generic_string();
        std::optional<Fields> fields = path_pattern.match(path);
        if (fields) {
            add_given(*fields, given);
            images.push_back(image_of(file, *fields));
        } else if (std::ranges::find(kImageExtensions, file.extension().string()) !=
                   kImageExtensions.end()) {
            passed_over.push_back(path);
        }
        if (example.empty()) example = path;
    }
    if (images.empty()) {
        throw Error(Errc::InvalidArgument,
                    "--pattern '" + pattern + "': no file below '" + folder.string() + "' fits" +
                        (example.empty() ? "" : "; there is '" + example + "'"));
    }
    return images;
}

std::vector<ImageToImport> images_of_list(const fs::path& list, const Fields& given) {
    const auto rows = parse_csv(list, read_file(list));
    if (rows.empty()) fail(list, "it is empty; its first line must name its columns");
    const std::vector<std::string>& names = rows.front();
    std::vector<std::string> known = kFields;
    known.emplace_back(kPath);
    for (const std::string& name : names) {
        if (std::ranges::find(known, name) == known.end()) {
            fail(list, unknown_name("column", name, known));
        }
    }
    const auto path = std::ranges::find(names, kPath) - names.begin();
    if (path == std::ssize(names)) fail(list, "it has no column 'path'");
    std::vector<ImageToImport> images;
    for (std::size_t r = 1; r < rows.size(); ++r) {
        if (rows[r].size() != names.size()) {
            fail(list, "row " + std::to_string(r + 1) + " has " + std::to_string(rows[r].size()) +
                           " fields, the first has " + std::to_string(names.size()));
        }
        Fields fields;
        for (std::size_t c = 0; c < names.size(); ++c) {
            if (!rows[r][c].empty() && names[c] != kPath) fields[names[c]] = rows[r][c];
        }
        add_given(fields, given);
        const std::string& file = rows[r][static_cast<std::size_t>(path)];
        images.push_back(image_of(list.parent_path() / file, fields));
    }
    return images;
}

}  // namespace misbench
