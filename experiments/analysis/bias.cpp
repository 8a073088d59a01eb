#include "experiments/analysis/bias.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "experiments/analysis/cell_images.h"
#include "experiments/statistics/intervals.h"
#include "experiments/statistics/multiplicity.h"
#include "renderer/base/error.h"
#include "renderer/base/render_statistics.h"

namespace misbench {
namespace {

// All seeds of one scene and method.
struct Renders {
    std::vector<std::int64_t> seeds;
    std::vector<TileSums> images;
    bool few_passes = false;
    std::optional<ErrorParts> parts;
};

// With the parts of a squared error, where there is one.
Renders renders_of(const Store& store, const Plan& plan, const std::string& scene,
                   const std::string& method, const Budget& budget,
                   std::optional<ErrorPartsSum> error) {
    Renders renders;
    for (const CellRun& run : finished_runs(store, plan, scene, method, budget)) {
        const Image image = store.run_image(run.run);
        renders.seeds.push_back(run.seed);
        renders.images.push_back(tile_sums(image.width, image.height, image.rgb));
        renders.few_passes |= has_few_passes(budget, store.run(run.run)->statistics.passes);
        if (error) error->add(image);
    }
    if (error && error->n_images() >= 2) renders.parts = error->parts();
    return renders;
}

// Null where the plan has none.
const Metric* first_squared_error(const Plan& plan) {
    for (const std::string& id : plan.metrics) {
        const Metric& metric = find_metric(id);
        if (metric.denominator != nullptr) return &metric;
    }
    return nullptr;
}

bool is_planned(const Plan& plan, const std::string& scene, const std::string& method,
                const Budget& budget) {
    return std::ranges::any_of(plan.cells, [&](const Cell& cell) {
        return cell.role == Role::Test && cell.scene == scene && cell.method == method &&
               cell.budget == budget;
    });
}

Budget wanted_budget(const Plan& plan, const std::string& budget) {
    if (budget.empty()) return plan.budgets.back();
    std::string known;
    for (const Budget& b : plan.budgets) {
        if (to_string(b) == budget) return b;
        known.append(" '").append(to_string(b)).append("'");
    }
    throw ParameterError("budget", "experiment '" + plan.experiment + "' has no budget '" + budget +
                                       "'; known:" + known);
}

std::string wanted_method(const Plan& plan, const std::string& method) {
    if (method.empty()) return plan.baseline;
    std::string known;
    for (const std::string& m : plan.methods) {
        if (m == method) return m;
        known.append(" '").append(m).append("'");
    }
    throw ParameterError("against", "experiment '" + plan.experiment + "' has no method '" +
                                        method + "'; known:" + known);
}

// Only the renders of these seeds.
Renders of_seeds(const Renders& renders, const std::vector<std::int64_t>& seeds) {
    Renders kept{
        .seeds = {}, .images = {}, .few_passes = renders.few_passes, .parts = renders.parts};
    for (std::size_t i = 0; i < renders.seeds.size(); ++i) {
        if (std::ranges::find(seeds, renders.seeds[i]) == seeds.end()) continue;
        kept.seeds.push_back(renders.seeds[i]);
        kept.images.push_back(renders.images[i]);
    }
    return kept;
}

BiasCell tested_cell(const Renders& method, const Renders& against, const BiasOptions& options) {
    BiasCell cell;
    cell.n_seeds = static_cast<int>(method.seeds.size());
    cell.n_seeds_against = static_cast<int>(against.seeds.size());
    cell.few_passes = method.few_passes || against.few_passes;
    if (std::min(cell.n_seeds, cell.n_seeds_against) < kFewestForInterval) return cell;
    cell.width = method.images.front().width;
    cell.height = method.images.front().height;
    cell.test = test_tiles(method.images, against.images,
                           {.is_paired = method.seeds == against.seeds,
                            .margin = options.margin,
                            .alpha = options.alpha});
    return cell;
}

bool is_too_bright_somewhere(const ImageTest& test, double alpha) {
    const auto n_scales = static_cast<double>(test.scales.size());
    return std::ranges::any_of(test.scales, [&](const ScaleTest& scale) {
        return std::ranges::any_of(scale.tiles, [&](const TileDifference& tile) {
            return tile.first > tile.second && n_scales * tile.adjusted_p <= alpha;
        });
    });
}

BiasFinding finding_of(const BiasCell& cell, double alpha) {
    if (!cell.test) return BiasFinding::NotEnoughSeeds;
    if (cell.test->strongest() == nullptr) return BiasFinding::NothingToTest;
    if (cell.adjusted_p <= alpha) {
        const bool all_within = std::ranges::all_of(
            cell.test->scales, [alpha](const ScaleTest& s) { return s.equivalence_p <= alpha; });
        if (all_within) return BiasFinding::Negligible;
        const bool may_be_rare = cell.test->rare_share > kMostInRareSamples &&
                                 !is_too_bright_somewhere(*cell.test, alpha);
        return may_be_rare ? BiasFinding::DarkOrRare : BiasFinding::Biased;
    }
    return cell.test->scales.back().equivalence_p <= alpha ? BiasFinding::Equivalent
                                                           : BiasFinding::NotFound;
}

}  // namespace

std::string to_string(BiasFinding finding) {
    switch (finding) {
        case BiasFinding::Biased:
            return "biased";
        case BiasFinding::DarkOrRare:
            return "dark, or rare samples";
        case BiasFinding::Negligible:
            return "within margin";
        case BiasFinding::Equivalent:
            return "equivalent (image)";
        case BiasFinding::NotFound:
            return "no bias found";
        case BiasFinding::NothingToTest:
            return "the same images";
        case BiasFinding::NotEnoughSeeds:
            break;
    }
    return "not enough seeds";
}

void decide(std::vector<BiasCell>& cells, double alpha) {
    std::vector<double> p;
    std::vector<BiasCell*> tested;
    for (BiasCell& cell : cells) {
        if (!cell.test || cell.test->strongest() == nullptr) continue;
        tested.push_back(&cell);
        p.push_back(cell.test->p_value);
    }
    const std::vector<double> adjusted = benjamini_hochberg(p);
    for (std::size_t i = 0; i < tested.size(); ++i) tested[i]->adjusted_p = adjusted[i];
    for (BiasCell& cell : cells) cell.finding = finding_of(cell, alpha);
}

Bias find_bias(const Store& store, const Plan& plan, const BiasOptions& options) {
    Bias bias{.experiment = plan.experiment,
              .against = wanted_method(plan, options.against),
              .budget = wanted_budget(plan, options.budget),
              .margin = options.margin,
              .alpha = options.alpha,
              .metric = {},
              .cells = {}};
    const Metric* metric = first_squared_error(plan);
    if (metric != nullptr) bias.metric = metric->id;
    for (const PlannedScene& scene : plan.scenes) {
        const auto reference = reference_images(store, plan, scene.name);
        std::optional<ErrorPartsSum> error;
        if (reference && metric != nullptr) {
            error.emplace(*metric, ReferencePair{reference->a, reference->b});
        }
        const Renders against =
            renders_of(store, plan, scene.name, bias.against, bias.budget, std::nullopt);
        for (const std::string& method : plan.methods) {
            if (method == bias.against || !is_planned(plan, scene.name, method, bias.budget)) {
                continue;
            }
            const Renders renders = renders_of(store, plan, scene.name, method, bias.budget, error);
            // Where some seeds are shared the others are left out: half pairs have no test.
            const Renders ours = of_seeds(renders, against.seeds);
            BiasCell cell = ours.seeds.empty()
                                ? tested_cell(renders, against, options)
                                : tested_cell(ours, of_seeds(against, ours.seeds), options);
            cell.scene = scene.name;
            cell.method = method;
            cell.parts = renders.parts;
            bias.cells.push_back(std::move(cell));
        }
    }
    decide(bias.cells, bias.alpha);
    return bias;
}

Image bias_map(const BiasCell& cell, const ScaleTest& scale) {
    Image map(cell.width, cell.height);
    std::ranges::fill(map.rgb, 1.0F);
    for (const TileDifference& tile : scale.tiles) {
        // Without noise any difference is beyond all.
        const double z = tile.standard_error > 0
                             ? tile.z()
                             : std::copysign(kFullColour, tile.first - tile.second);
        const auto rest = static_cast<float>(1 - std::min(1.0, std::abs(z) / kFullColour));
        const std::size_t full = z > 0 ? 0 : 2;  // the channel that stays
        for (int y = tile.tile.y0; y < tile.tile.y1; ++y) {
            for (int x = tile.tile.x0; x < tile.tile.x1; ++x) {
                const auto pixel = 3 * static_cast<std::size_t>(y * map.width + x);
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    if (channel != full) map.rgb[pixel + channel] = rest;
                }
            }
        }
    }
    return map;
}

}  // namespace misbench
