// misbench diff: how two stores differ.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "experiments/analysis/store_diff.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/numbers.h"

namespace misbench {
namespace {

constexpr int kExitDifferent = 1;

std::string to_text(const DiffPlace& place) {
    return fmt::format("{}: {}, {}, {}", place.experiment, place.scene, place.method, place.budget);
}

std::string to_text(const std::vector<std::int64_t>& seeds) {
    return fmt::format("seed{} {}", seeds.size() == 1 ? "" : "s", fmt::join(seeds, " "));
}

std::string to_text(const Record& record) {
    const Provenance& from = record.provenance;
    return fmt::format("build {} on {} ({}, {}), {} threads", from.build_id, from.host,
                       from.cpu_model, from.isa, record.statistics.threads);
}

std::string missing_to_text(const std::string& store, const std::vector<std::string>& experiments,
                            const DiffSeeds& runs) {
    std::string text;
    for (const std::string& name : experiments) {
        text += fmt::format("only in {}: experiment '{}'\n", store, name);
    }
    for (const auto& [place, seeds] : runs) {
        text += fmt::format("only in {}: {}, {}\n", store, to_text(place), to_text(seeds));
    }
    return text;
}

std::string means_to_text(const StoreDiff& diff, const DiffOptions& options) {
    if (diff.means.empty()) return "no means to compare\n";
    std::string text;
    int n_identical = 0;
    int n_undecided = 0;
    int n_different = 0;
    for (const DiffMean& mean : diff.means) {
        n_identical += mean.is_identical ? 1 : 0;
        if (!mean.is_identical && mean.ratio.why_none) ++n_undecided;
        if (!mean.differs()) continue;
        ++n_different;
        text +=
            fmt::format("other mean: {}: {} / {} {}{}\n", to_text(mean.place), options.a, options.b,
                        format_ratio(mean.ratio), mean.is_paired ? ", paired by seed" : "");
    }
    return text + fmt::format(
                      "{} means compared, intervals 95 % for all of them together: {} "
                      "identical, {} differ, {} without interval\n",
                      diff.means.size(), n_identical, n_different, n_undecided);
}

std::string to_text(const StoreDiff& diff, const DiffOptions& options) {
    std::string text = missing_to_text(options.a, diff.only_a, diff.runs_only_a) +
                       missing_to_text(options.b, diff.only_b, diff.runs_only_b);
    for (const auto& [key, seeds] : diff.tasks) {
        text +=
            fmt::format("other task: {}, {}: {}\n", to_text(key.first), to_text(seeds), key.second);
    }
    int n_at_equal_time = 0;
    for (const DiffImage& image : diff.images) {
        if (!image.must_be_equal) {
            ++n_at_equal_time;
            continue;
        }
        text += fmt::format("not reproduced: {}, seed {}, run {}\n  {}: {}\n  {}: {}\n",
                            to_text(image.place), image.seed, image.run, options.a,
                            to_text(image.a), options.b, to_text(image.b));
    }
    text += fmt::format("{} images are the same in both", diff.n_equal_images);
    if (n_at_equal_time > 0) {
        text += fmt::format("; {} are others, of runs at equal time, as is to be expected",
                            n_at_equal_time);
    }
    return text + "\n" + means_to_text(diff, options) +
           (diff.is_same() ? "no differences\n" : "the stores differ\n");
}

nlohmann::ordered_json to_json(const DiffPlace& place) {
    return {{"experiment", place.experiment},
            {"scene", place.scene},
            {"method", place.method},
            {"budget", place.budget}};
}

nlohmann::ordered_json to_json(const DiffSeeds& runs) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& [place, seeds] : runs) {
        json.push_back(to_json(place));
        json.back()["seeds"] = seeds;
    }
    return json;
}

nlohmann::ordered_json to_json(const Record& record) {
    const nlohmann::json whole = record_to_json(record);
    return {{"image_sha256", record.image_sha256},
            {"finished_at", record.finished_at},
            {"threads", record.statistics.threads},
            {"passes", record.statistics.passes},
            {"provenance", whole.at("provenance")}};
}

std::string to_json(const StoreDiff& diff) {
    nlohmann::ordered_json json = {{"same", diff.is_same()},
                                   {"experiments", diff.experiments},
                                   {"experiments_only_in_a", diff.only_a},
                                   {"experiments_only_in_b", diff.only_b},
                                   {"runs_only_in_a", to_json(diff.runs_only_a)},
                                   {"runs_only_in_b", to_json(diff.runs_only_b)},
                                   {"equal_images", diff.n_equal_images}};
    auto& tasks = json["other_tasks"] = nlohmann::ordered_json::array();
    for (const auto& [key, seeds] : diff.tasks) {
        tasks.push_back(to_json(key.first));
        tasks.back()["seeds"] = seeds;
        tasks.back()["differences"] = key.second;
    }
    auto& images = json["other_images"] = nlohmann::ordered_json::array();
    for (const DiffImage& image : diff.images) {
        images.push_back(to_json(image.place));
        images.back()["seed"] = image.seed;
        images.back()["run"] = image.run;
        images.back()["must_be_equal"] = image.must_be_equal;
        images.back()["a"] = to_json(image.a);
        images.back()["b"] = to_json(image.b);
    }
    auto& means = json["means"] = nlohmann::ordered_json::array();
    for (const DiffMean& mean : diff.means) {
        means.push_back(to_json(mean.place));
        auto& row = means.back();
        row["ratio"] = mean.ratio.value;
        row["low"] = nullptr;
        row["high"] = nullptr;
        if (mean.ratio.interval) {
            row["low"] = mean.ratio.interval->low;
            row["high"] = mean.ratio.interval->high;
        }
        row["paired"] = mean.is_paired;
        row["identical"] = mean.is_identical;
        row["differs"] = mean.differs();
    }
    return json.dump(2) + "\n";
}

}  // namespace

int diff_verb(const DiffOptions& options) {
    const Store a(options.a, Store::Access::ReadOnly);
    const Store b(options.b, Store::Access::ReadOnly);
    const StoreDiff diff = diff_stores(a, b, options.experiment, options.metric);
    print_result(options.json ? to_json(diff) : to_text(diff, options));
    return diff.is_same() ? 0 : kExitDifferent;
}

}  // namespace misbench
