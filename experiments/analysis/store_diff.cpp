#include "experiments/analysis/store_diff.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "experiments/plan/task_difference.h"

namespace misbench {
namespace {

// The finished cells of a plan by their place and seed.
using Finished = std::map<std::pair<DiffPlace, std::int64_t>, const Cell*>;

Finished finished_cells(const Store& store, const Plan& plan) {
    Finished finished;
    for (const Cell& cell : plan.cells) {
        if (!store.has_run(task_id(cell.task))) continue;
        const bool is_test = cell.role == Role::Test;
        const DiffPlace place{.experiment = plan.experiment,
                              .scene = cell.scene,
                              .method = is_test ? cell.method : to_string(cell.role),
                              .budget = to_string(cell.budget)};
        finished[{place, cell.seed}] = &cell;
    }
    return finished;
}

void find_missing(const Finished& in, const Finished& other, DiffSeeds& missing) {
    for (const auto& [key, cell] : in) {
        if (!other.contains(key)) missing[key.first].push_back(key.second);
    }
}

void compare_run(const Store& a, const Store& b, const DiffPlace& place, std::int64_t seed,
                 const Task& task, StoreDiff& diff) {
    const std::string id = task_id(task);
    DiffImage image{.place = place,
                    .seed = seed,
                    .run = id,
                    .must_be_equal = std::holds_alternative<SampleBudget>(task.budget),
                    .a = a.run(id).value(),
                    .b = b.run(id).value()};
    // Files may differ in their headers alone.
    const bool is_same =
        image.a.image_sha256 == image.b.image_sha256 || a.run_image(id) == b.run_image(id);
    if (is_same) {
        ++diff.n_equal_images;
    } else {
        diff.images.push_back(std::move(image));
    }
}

void compare_runs(const Store& a, const Store& b, const Plan& plan_a, const Plan& plan_b,
                  StoreDiff& diff) {
    const Finished in_a = finished_cells(a, plan_a);
    const Finished in_b = finished_cells(b, plan_b);
    find_missing(in_a, in_b, diff.runs_only_a);
    find_missing(in_b, in_a, diff.runs_only_b);
    for (const auto& [key, cell] : in_a) {
        const auto there = in_b.find(key);
        if (there == in_b.end()) continue;
        const auto differences = task_differences(cell->task, there->second->task);
        if (differences.empty()) {
            compare_run(a, b, key.first, key.second, cell->task, diff);
        } else {
            diff.tasks[{key.first, to_string(differences)}].push_back(key.second);
        }
    }
}

// Log ratios first: how many there are decides how wide their intervals are.
struct CellRatio {
    DiffPlace place;
    LogRatio ratio;
    bool is_paired = false;
};

void compare_means(const Store& a, const Store& b, const Plan& plan_a, const Plan& plan_b,
                   const std::string& metric, std::vector<CellRatio>& ratios) {
    const Comparison in_a = compare(a, plan_a, metric);
    const Comparison in_b = compare(b, plan_b, in_a.metric);
    for (const ComparedCell& cell : in_a.cells) {
        const ComparedCell* other = in_b.find(cell.scene, cell.method, cell.budget);
        if (other == nullptr) continue;
        const auto ratio = log_ratio(cell, *other);
        if (!ratio) continue;
        ratios.push_back({{plan_a.experiment, cell.scene, cell.method, to_string(cell.budget)},
                          *ratio,
                          are_paired(cell, *other)});
    }
}

std::vector<DiffMean> judge(const std::vector<CellRatio>& ratios) {
    const auto decides = [](const CellRatio& r) { return !r.ratio.is_identity; };
    const auto n = std::max<std::ptrdiff_t>(1, std::ranges::count_if(ratios, decides));
    const double confidence = 1 - (1 - kConfidence) / static_cast<double>(n);
    std::vector<DiffMean> means;
    for (const auto& [place, ratio, is_paired] : ratios) {
        means.push_back({.place = place,
                         .ratio = to_ratio(ratio, confidence),
                         .is_paired = is_paired,
                         .is_identical = ratio.is_identity});
    }
    return means;
}

}  // namespace

bool StoreDiff::is_same() const {
    const auto must_be_equal = [](const DiffImage& image) { return image.must_be_equal; };
    const auto differs = [](const DiffMean& mean) { return mean.differs(); };
    return only_a.empty() && only_b.empty() && runs_only_a.empty() && runs_only_b.empty() &&
           tasks.empty() && std::ranges::none_of(images, must_be_equal) &&
           std::ranges::none_of(means, differs);
}

StoreDiff diff_stores(const Store& a, const Store& b, const std::string& experiment,
                      const std::string& metric) {
    std::vector<std::string> in_a{experiment};
    std::vector<std::string> in_b{experiment};
    if (experiment.empty()) {
        in_a = a.experiments();
        in_b = b.experiments();
        std::ranges::sort(in_a);
        std::ranges::sort(in_b);
    }
    StoreDiff diff;
    std::ranges::set_difference(in_a, in_b, std::back_inserter(diff.only_a));
    std::ranges::set_difference(in_b, in_a, std::back_inserter(diff.only_b));
    std::ranges::set_intersection(in_a, in_b, std::back_inserter(diff.experiments));
    std::vector<CellRatio> ratios;
    for (const std::string& name : diff.experiments) {
        const Plan plan_a = a.experiment(name);
        const Plan plan_b = b.experiment(name);
        compare_runs(a, b, plan_a, plan_b, diff);
        compare_means(a, b, plan_a, plan_b, metric, ratios);
    }
    diff.means = judge(ratios);
    return diff;
}

}  // namespace misbench
