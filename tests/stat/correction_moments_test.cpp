// Second moments that samples weighed by a baseline predict for weights with a factor, against
// those of samples that are weighed with it; and that the factors chosen are those of least moment.
//
// F_γ   a pixel's value in one pass, with factor γ in front of a group of techniques
// M_γ   E[F_γ²]
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>

#include "renderer/methods/render_loop.h"
#include "renderer/mis/factors.h"
#include "renderer/mis/heuristics.h"
#include "renderer/paths/sample.h"
#include "renderer/scene/load.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kComparisons = 40;  // at the most
constexpr int kSeeds = 150;       // of either side
constexpr int kWidth = 12;
constexpr int kHeight = 9;
constexpr std::array kCandidates = {0.02, 0.2, 5.0};

std::int64_t n(std::int64_t value) { return value; }
std::string text(const char* value) { return value; }

struct Group {
    std::string name;
    TechniqueKind kind;
    std::string method;
    ParameterMap parameters;  // only paths that have a technique of the group
};
const std::vector<Group>& groups() {
    static const std::vector<Group> kGroups = {
        {"merge",
         TechniqueKind::Merge,
         "vcm",
         {{"min_depth", n(3)},
          {"max_depth", n(4)},
          {"radius", text("global")},
          {"radius_scale", 0.02}}},
        {"light", TechniqueKind::Light, "bdpt", {{"min_depth", n(2)}, {"max_depth", n(2)}}},
        {"nee", TechniqueKind::NextEvent, "bdpt", {{"min_depth", n(2)}, {"max_depth", n(3)}}},
    };
    return kGroups;
}

// F_γ of one pass by pixel, made of the samples of a render of one thread.
class Values final : public SampleObserver {
 public:
    using Ratio = std::function<double(const Sample&, double gamma)>;  // w_γ

    Values(std::span<const double> gammas, Ratio weight)
        : gammas_(gammas.begin(), gammas.end()), weight_(std::move(weight)) {
        start_pass();
    }
    bool wants_weights() const override { return true; }
    void observe(const Sample& sample, std::size_t /*chunk*/) override {
        const std::size_t pixel = sample.path.pixel.index(kWidth);
        const double value =
            (double{sample.value.r} + double{sample.value.g} + double{sample.value.b}) / 3;
        for (std::size_t c = 0; c < gammas_.size(); ++c) {
            values_[c][pixel] += weight_(sample, gammas_[c]) * value;
        }
    }
    void start_pass() { values_.assign(gammas_.size(), std::vector<double>(kWidth * kHeight)); }
    const std::vector<double>& of_candidate(std::size_t c) const { return values_[c]; }
    // Over the pixels.
    double mean_square(std::size_t c) const {
        double sum = 0;
        for (const double f : values_[c]) sum += f * f / (kWidth * kHeight);
        return sum;
    }

 private:
    std::vector<double> gammas_;
    Ratio weight_;
    std::vector<std::vector<double>> values_;
};

// From the weights that the sample and its group have.                            [hua2025 Eq. 22]
double predicted_weight(const Sample& sample, TechniqueKind kind, double gamma) {
    if (sample.weights.empty()) return sample.weight;
    const int n_edges = sample.path.n_edges();
    double group = 0;
    double others = 0;
    for (std::size_t t = 0; t < sample.weights.size(); ++t) {
        const bool is_own = technique_at(static_cast<int>(t), n_edges).kind == kind;
        (is_own ? group : others) += sample.weights[t];
    }
    return sample.weight *
           corrected_weight_ratio(gamma, sample.technique.kind == kind, group, others);
}

// From the densities, with the factor in front of the heuristic's shares.     [hua2025 Eq. 17, 18]
double weight_with_factor(const Sample& sample, const Heuristic& heuristic, TechniqueKind kind,
                          double gamma) {
    if (sample.q.empty()) return sample.weight;
    const int n_edges = sample.path.n_edges();
    std::vector<double> u(sample.q.begin(), sample.q.end());
    for (std::size_t t = 0; t < sample.factors.size(); ++t) u[t] *= sample.factors[t];
    heuristic.shares(u);
    double sum = 0;
    for (std::size_t t = 0; t < u.size(); ++t) {
        if (technique_at(static_cast<int>(t), n_edges).kind == kind) u[t] *= gamma;
        sum += u[t];
    }
    return u[static_cast<std::size_t>(sample.technique.index(n_edges))] / sum;
}

struct NamedScene {
    std::string name;
    std::shared_ptr<const Scene> scene;
};
std::vector<NamedScene> scenes() {
    SceneDescription lamp = test::open_box();
    lamp.meshes.push_back(test::ceiling_lamp());
    SceneDescription gloss = lamp;
    gloss.materials[0] = test::surface(
        RoughPlasticMaterial({.diffuse_reflectance = {0.5F, 0.5F, 0.5F}, .alpha = 0.3F}));
    const LoadedScene cornell =
        load_scene(std::string(MISBENCH_SCENES) + "/CornellBox/CornellBox.json", 1);
    return {{"lamp", std::make_shared<const Scene>(lamp, 1)},
            {"gloss", std::make_shared<const Scene>(gloss, 1)},
            {"cornell", cornell.scene}};
}

RenderRequest request(const Group& group, std::int64_t seed, ParameterMap more) {
    more.insert(group.parameters.begin(), group.parameters.end());
    return {.method = group.method,
            .parameters = std::move(more),
            .width = kWidth,
            .height = kHeight,
            .budget = SampleBudget{1},
            .seed = seed};
}

// M_γ of one pass over the image, by seed and by candidate.
std::vector<std::vector<double>> mean_squares(const Scene& scene, const Group& group,
                                              std::int64_t first_seed, const ParameterMap& more,
                                              std::span<const double> gammas,
                                              const Values::Ratio& weight) {
    std::vector<std::vector<double>> all(gammas.size());
    for (std::int64_t seed = first_seed; seed < first_seed + kSeeds; ++seed) {
        Values values(gammas, weight);
        RenderRequest one = request(group, seed, more);
        one.observer = &values;
        EXPECT_TRUE(render(scene, one).valid);
        for (std::size_t c = 0; c < gammas.size(); ++c) all[c].push_back(values.mean_square(c));
    }
    return all;
}

TEST(CorrectionMoments, ArePredictedFromTheBaselinesSamples) {
    const double level = test::sidak(kAlpha, kComparisons);
    for (const NamedScene& scene : scenes()) {
        for (const Group& group : groups()) {
            // Baselines differ: by factors, by the heuristic. A power leaves merging no weight.
            ParameterMap baseline;
            std::string mis = "balance";
            if (scene.name == "gloss") baseline["factors"] = text("correlation");
            if (scene.name == "cornell" && group.name != "merge") mis = "power2";
            baseline["mis"] = mis;
            const Heuristic heuristic = Heuristic::parse(mis);
            const auto predicted =
                mean_squares(*scene.scene, group, 1000, baseline, kCandidates,
                             [&](const Sample& sample, double gamma) {
                                 return predicted_weight(sample, group.kind, gamma);
                             });
            const auto weigh = [&](const Sample& sample, double gamma) {
                return weight_with_factor(sample, heuristic, group.kind, gamma);
            };
            const auto measured =
                mean_squares(*scene.scene, group, 2000, baseline, kCandidates, weigh);
            const std::array unchanged = {1.0};
            const auto without =
                mean_squares(*scene.scene, group, 2000, baseline, unchanged, weigh);
            double largest_effect = 0;
            for (std::size_t c = 0; c < kCandidates.size(); ++c) {
                std::vector<double> differences;
                double mean_measured = 0;
                double mean_without = 0;
                for (std::size_t i = 0; i < kSeeds; ++i) {
                    differences.push_back(predicted[c][i] - measured[c][i]);
                    mean_measured += measured[c][i];
                    mean_without += without[0][i];
                }
                largest_effect =
                    std::max(largest_effect, std::abs(mean_measured / mean_without - 1));
                EXPECT_GT(test::p_value_of_mean(differences, 0), level)
                    << scene.name << ' ' << group.name << ' ' << kCandidates[c];
            }
            EXPECT_GT(largest_effect, 0.02) << scene.name << ' ' << group.name
                                            << ": no factor changes anything that could be seen";
        }
    }
}

// Counting the samples of a group as one is a factor of one over their number: this one is not made
// of the samples' weights but rendered.
TEST(CorrectionMoments, ArePredictedForAnImageRenderedWithTheFactor) {
    const double level = test::sidak(kAlpha, kComparisons);
    for (const NamedScene& scene : scenes()) {
        for (const std::string name : {"merge", "nee"}) {
            const Group& group = *std::find_if(groups().begin(), groups().end(),
                                               [&](const Group& g) { return g.name == name; });
            constexpr int kShadowRays = 16;
            ParameterMap parameters;
            if (name == "nee") parameters["shadow_rays"] = n(kShadowRays);
            const std::array gamma = {1.0 / (name == "nee" ? kShadowRays : kWidth * kHeight)};
            const auto predicted = mean_squares(*scene.scene, group, 3000, parameters, gamma,
                                                [&](const Sample& sample, double g) {
                                                    return predicted_weight(sample, group.kind, g);
                                                });
            parameters["factors"] = text("popov");
            std::vector<double> differences;
            for (int i = 0; i < kSeeds; ++i) {
                const Image image =
                    render(*scene.scene, request(group, 4000 + i, parameters)).image;
                double measured = 0;
                for (std::size_t k = 0; k < image.rgb.size(); k += 3) {
                    const double f = (double{image.rgb[k]} + double{image.rgb[k + 1]} +
                                      double{image.rgb[k + 2]}) /
                                     3;
                    measured += f * f / (kWidth * kHeight);
                }
                differences.push_back(predicted[0][static_cast<std::size_t>(i)] - measured);
            }
            EXPECT_GT(test::p_value_of_mean(differences, 0), level) << scene.name << ' ' << name;
        }
    }
}

TEST(CorrectionMoments, DecideWhichFactorIsChosen) {
    constexpr int kPasses = 12;
    const std::array candidates = {0.02, 0.2, 5.0, 1.0};
    for (const NamedScene& scene : scenes()) {
        for (const Group& group : groups()) {
            const ParameterMap learning = {{"factors", text("correction")},
                                           {"training", n(kPasses)},
                                           {"correction_groups", group.name},
                                           {"correction_candidates", text("0.02,0.2,5")},
                                           {"correction_filter", text("none")}};
            std::vector<std::vector<double>> moments(candidates.size(),
                                                     std::vector<double>(kWidth * kHeight));
            for (std::int64_t pass = 0; pass < kPasses; ++pass) {
                Values values(candidates, [&](const Sample& sample, double gamma) {
                    return weight_with_factor(sample, Heuristic::parse("balance"), group.kind,
                                              gamma);
                });
                RenderRequest one = request(group, 77, {});
                one.only_pass = pass;
                one.observer = &values;
                render(*scene.scene, one);
                for (std::size_t c = 0; c < candidates.size(); ++c) {
                    for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
                        const double f = values.of_candidate(c)[i];
                        moments[c][i] += f * f;
                    }
                }
            }
            RenderRequest learned = request(group, 77, learning);
            learned.budget = SampleBudget{kPasses};
            const RenderResult result = render(*scene.scene, learned);
            ASSERT_EQ(result.maps.size(), 1U) << scene.name << ' ' << group.name;
            int n_compared = 0;
            for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
                std::vector<std::pair<double, double>> order;
                for (std::size_t c = 0; c < candidates.size(); ++c) {
                    order.emplace_back(moments[c][i], candidates[c]);
                }
                std::sort(order.begin(), order.end());
                const bool is_black = order.back().first == 0;
                if (is_black) order[0].second = 1;
                if (!is_black && order[1].first < 1.0001 * order[0].first) continue;  // rounding
                ++n_compared;
                EXPECT_EQ(result.maps[0].image.rgb[3 * i], static_cast<float>(order[0].second))
                    << scene.name << ' ' << group.name << ' ' << i;
            }
            EXPECT_GT(n_compared, kWidth * kHeight / 4) << scene.name << ' ' << group.name;
        }
    }
}

}  // namespace
}  // namespace misbench
