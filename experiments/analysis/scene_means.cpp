#include "experiments/analysis/scene_means.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "experiments/statistics/bootstrap.h"

namespace misbench {
namespace {

std::string group_of(const std::string& scene) { return scene.substr(0, scene.find('/')); }

// The cells of a method that have ratios, in all of the scenes that have the method. Empty where
// one lacks a ratio.
std::vector<const ComparedCell*> cells_of(const Comparison& comparison,
                                          const std::vector<std::string>& scenes,
                                          const std::string& method, const Budget& budget) {
    std::vector<const ComparedCell*> cells;
    for (const std::string& scene : scenes) {
        const ComparedCell* cell = comparison.find(scene, method, budget);
        if (cell == nullptr) continue;
        if (!cell->ratio_log) return {};
        cells.push_back(cell);
    }
    return cells;
}

void set_ratio_of_these(ComparedCell& mean, const std::vector<const ComparedCell*>& cells) {
    std::vector<LogRatio> ratios;
    for (const ComparedCell* cell : cells) ratios.push_back(*cell->ratio_log);
    mean.ratio_log = mean_log_ratio(ratios);
    mean.ratio = to_ratio(*mean.ratio_log);
    mean.ratio_is_paired = std::ranges::all_of(cells, &ComparedCell::ratio_is_paired);
    if (!mean.ratio_log->why_none || mean.ratio_log->is_identity) {
        mean.p = p_value(*mean.ratio_log);
    }
}

void set_ratio_of_such(ComparedCell& mean, const std::vector<const ComparedCell*>& cells) {
    std::vector<double> values;
    bool is_honest = true;
    for (const ComparedCell* cell : cells) {
        values.push_back(cell->ratio_log->value);
        is_honest &= cell->ratio_log->why_none != NoInterval::HeavyTail;
    }
    mean.ratio = geometric_mean_over_scenes(values);
    if (is_honest || !mean.ratio->interval) return;
    mean.ratio->interval.reset();
    mean.ratio->why_none = NoInterval::HeavyTail;
}

std::string name_of_these(std::size_t n) {
    return n == 1 ? "this scene" : fmt::format("these {} scenes", n);
}

std::string name_of_such(std::size_t n) {
    return n == 1 ? "scenes like this" : fmt::format("scenes like these {}", n);
}

struct SceneMean {
    std::string (*name)(std::size_t n);
    void (*set_ratio)(ComparedCell& mean, const std::vector<const ComparedCell*>& cells);
};
constexpr SceneMean kSceneMeans[] = {{name_of_these, set_ratio_of_these},
                                     {name_of_such, set_ratio_of_such}};

}  // namespace

void add_means_over_scenes(Comparison& comparison, bool by_group) {
    std::map<std::string, std::vector<std::string>> groups;
    for (const std::string& scene : comparison.scenes) {
        groups[by_group ? group_of(scene) : ""].push_back(scene);
    }
    std::vector<ComparedCell> means;
    for (const auto& [group, scenes] : groups) {
        for (const SceneMean& kind : kSceneMeans) {
            const std::string name =
                "geometric mean of " + kind.name(scenes.size()) + (by_group ? " of " + group : "");
            comparison.scenes.push_back(name);
            for (const Budget& budget : comparison.budgets) {
                for (const std::string& method : comparison.methods) {
                    const auto cells = cells_of(comparison, scenes, method, budget);
                    if (cells.empty()) continue;
                    ComparedCell& mean = means.emplace_back();
                    mean.scene = name;
                    mean.method = method;
                    mean.budget = budget;
                    mean.is_mean_of_scenes = true;
                    kind.set_ratio(mean, cells);
                }
            }
        }
    }
    std::ranges::move(means, std::back_inserter(comparison.cells));
}

}  // namespace misbench
