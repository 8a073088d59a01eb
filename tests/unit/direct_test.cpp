// What holds of direct light exactly, whatever the random numbers: which densities its weights are
// made of, and what is known in which pass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <mutex>

#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/next_event.h"
#include "renderer/methods/render_loop.h"
#include "renderer/methods/resampling.h"
#include "renderer/paths/sample.h"
#include "renderer/scene/bsdf.h"
#include "renderer/scene/load.h"
#include "tests/support/allocations.h"
#include "tests/support/gallery.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 18;

std::int64_t n(std::int64_t value) { return value; }
std::string text(const char* value) { return value; }

ParameterMap nabata(ParameterMap parameters = {}) {
    parameters.insert({{"candidates", n(8)},
                       {"resampled_density", text("nabata")},
                       {"light_selection", text("area")}});
    return parameters;
}

RenderResult render_with(const Scene& scene, const ParameterMap& parameters, std::int64_t samples,
                         SampleObserver* observer = nullptr,
                         std::optional<std::int64_t> only_pass = {}, std::int64_t seed = 7) {
    return render(scene, {.method = "direct",
                          .parameters = parameters,
                          .width = kWidth,
                          .height = kHeight,
                          .budget = SampleBudget{samples},
                          .seed = seed,
                          .threads = 2,
                          .observer = observer,
                          .only_pass = only_pass});
}

const Scene& veach_mis() {
    static const LoadedScene kLoaded =
        load_scene(std::string(MISBENCH_SCENES) + "/VeachMIS/VeachMIS.json", 1);
    return *kLoaded.scene;
}
// Lights of all kinds over surfaces of all kinds.
const Scene& gallery() {
    static const Scene kScene(
        test::lit_from_far(test::lit_by_points(test::lit_by_surfaces(test::gallery()))), 1);
    return kScene;
}

TEST(Reservoir, KeepsInProportionToTheWeights) {
    constexpr std::array kWeights = {0.0, 3.0, 0.0, 1.0, 4.0};
    constexpr int kRounds = 20'000;
    std::array<int, 5> counts{};
    for (std::uint32_t round = 0; round < kRounds; ++round) {
        Rng rng(1, round, 0);
        Reservoir reservoir;
        std::size_t survivor = 9;
        for (std::size_t i = 0; i < kWeights.size(); ++i) {
            if (reservoir.keeps(kWeights[i], rng)) survivor = i;
        }
        ++counts.at(survivor);
        EXPECT_EQ(reservoir.weight_sum(), 8);
    }
    for (std::size_t i = 0; i < kWeights.size(); ++i) {
        const double p = kWeights[i] / 8;
        EXPECT_NEAR(counts.at(i), p * kRounds, 5 * std::sqrt(p * (1 - p) * kRounds)) << i;
    }
}

TEST(Reservoir, HasASurvivorWithoutWeightAndDrawsNothingForOne) {
    Rng rng(1, 0, 0);
    Rng untouched(1, 0, 0);
    Reservoir reservoir;
    EXPECT_TRUE(reservoir.keeps(0, rng));
    EXPECT_FALSE(reservoir.keeps(0, rng));
    EXPECT_TRUE(reservoir.keeps(2, rng));
    EXPECT_FALSE(reservoir.keeps(0, rng));
    EXPECT_EQ(rng.uniform(), untouched.uniform());
}

TEST(ResampledDensity, LiesBetweenCandidatesAndTarget) {
    // (1/4 / 2 + 3/4 · 5 / 3)⁻¹
    EXPECT_DOUBLE_EQ(resampled_density(2, 3, 5, 4), 1 / 1.375);
    EXPECT_EQ(resampled_density(2, 3, 5, 1), 2);
    EXPECT_NEAR(resampled_density(2, 3, 5, 1e12), 3.0 / 5, 1e-10);
    EXPECT_EQ(resampled_density(2, 0, 5, 4), 0);
}

// The densities of direct light, from the path's vertices alone.
class Densities final : public SampleObserver {
 public:
    // P by pixel; empty: the candidates' density.
    Densities(const Scene& scene, double n_candidates, std::vector<float> normalization)
        : scene_(scene),
          next_event_(scene, find_light_selection("area")),
          n_candidates_(n_candidates),
          normalization_(std::move(normalization)) {}

    bool wants_weights() const override { return true; }
    void observe(const Sample& sample, std::size_t /*chunk*/) override {
        const PathView& path = sample.path;
        if (path.n_edges() < 2) return;
        const std::lock_guard lock(mutex_);
        ++n_of_kind_[static_cast<std::size_t>(sample.technique.kind)];
        const PathDensities& d = *path.densities;
        const bool ends_at_delta_light = !path.light.empty() && path.light.front().is_delta_light;
        if (d.is_delta[1] != 0 || ends_at_delta_light) {
            EXPECT_EQ(sample.weight, 1);
            return;
        }
        const SurfacePoint& x = path.vertex(1).point;
        const SurfacePoint& light = path.vertex(2).point;
        const bool is_infinite = !path.light.empty() && path.light.front().is_infinite;
        const Vec3 w =
            is_infinite ? -path.light.front().wo : normalized(light.position - x.position);

        // BSDF sampling has the density p_b in the measure of x_2, candidates have q.
        const BsdfValue f = Bsdf(scene_, x, path.vertex(1).wo).evaluate(w);
        const double measure = is_infinite ? 1 : solid_angle_to_area(1, x.position, light);
        const double p_b = f.pdf * measure;
        const double q = is_infinite ? next_event_.environment_pdf(x.position, w)
                                     : next_event_.pdf_area(x.position, light);
        double p_nee = q;
        if (!normalization_.empty()) {
            const Rgb le = is_infinite ? scene_.background(w) : scene_.emitted(light, -w);
            const Rgb value = f.f_cos * le;
            const double target =
                (double{value.r} + double{value.g} + double{value.b}) / 3 * measure;
            const double p = double{normalization_[3 * path.pixel.index(kWidth)]};
            const double m = n_candidates_;
            if (p > 0) p_nee = 1 / (1 / (m * q) + (m - 1) / m * p / target);
        }
        // A narrow lobe's direction in another frame is rounded otherwise.
        constexpr double kTolerance = 1e-2;
        EXPECT_NEAR(d.next_event / p_nee, 1, 1e-4);
        EXPECT_NEAR(d.from_camera[2] / p_b, 1, kTolerance);
        const bool is_hit = sample.technique.kind == TechniqueKind::Hit;
        const double sum = p_b + p_nee;
        EXPECT_NEAR(sample.weight, (is_hit ? p_b : p_nee) / sum, kTolerance);
        ASSERT_EQ(sample.weights.size(), 4U);
        EXPECT_NEAR(sample.weights[0] + sample.weights[1], 1, 1e-12);
        EXPECT_EQ(sample.weights[2] + sample.weights[3], 0);
    }
    std::size_t n_of(TechniqueKind kind) const {
        return n_of_kind_[static_cast<std::size_t>(kind)];
    }

 private:
    const Scene& scene_;
    NextEvent next_event_;
    double n_candidates_;
    std::vector<float> normalization_;
    std::mutex mutex_;
    std::array<std::size_t, 5> n_of_kind_{};
};

TEST(Direct, WeighsBothTechniquesWithTheSameDensities) {
    for (const Scene* scene : {&veach_mis(), &gallery()}) {
        for (const char* resampled_density : {"candidate", "nabata"}) {
            ParameterMap parameters = nabata();
            parameters["resampled_density"] = text(resampled_density);
            // What is known after three passes is used in the fourth.
            const RenderResult before = render_with(*scene, parameters, 3);
            EXPECT_EQ(before.maps.size(), resampled_density == text("nabata") ? 1U : 0U);
            Densities densities(
                *scene, 8,
                before.maps.empty() ? std::vector<float>{} : before.maps.front().image.rgb);
            const RenderResult result = render_with(*scene, parameters, 4, &densities, 3);
            EXPECT_TRUE(result.valid);
            EXPECT_GT(densities.n_of(TechniqueKind::Hit), 30U) << resampled_density;
            EXPECT_GT(densities.n_of(TechniqueKind::NextEvent), 200U) << resampled_density;
        }
    }
}

TEST(Direct, KnowsNothingInTheFirstPass) {
    Densities densities(veach_mis(), 8, {});
    render_with(veach_mis(), nabata(), 1, &densities, 0);
    EXPECT_GT(densities.n_of(TechniqueKind::NextEvent), 200U);
    ParameterMap candidate = nabata();
    candidate["resampled_density"] = text("candidate");
    EXPECT_EQ(render_with(veach_mis(), nabata(), 1).image,
              render_with(veach_mis(), candidate, 1).image);
    EXPECT_NE(render_with(veach_mis(), nabata(), 2).image,
              render_with(veach_mis(), candidate, 2).image);
}

// Nothing is in the way from this floor to the lamp, so that light samples have no weight on it but
// what P is the mean of: P is the light that all of them find.
class NextEvents final : public SampleObserver {
 public:
    NextEvents() : sums_(kWidth * kHeight) {}
    bool wants_zeros() const override { return true; }
    void observe(const Sample& sample, std::size_t /*chunk*/) override {
        if (sample.technique.kind != TechniqueKind::NextEvent) return;
        const Rgb value = sample.value;
        sums_[sample.path.pixel.index(kWidth)] +=
            (double{value.r} + double{value.g} + double{value.b}) / 3;
    }
    const std::vector<double>& sums() const { return sums_; }

 private:
    std::vector<double> sums_;
};

TEST(Direct, LearnsTheMeanOfWhatTheCandidatesSayAndNothingTwice) {
    const Scene scene(test::floor_under_lamp({0.8F, 0.6F, 0.4F}, {5, 6, 7}), 1);
    NextEvents next_events;
    const RenderResult result =
        render_with(scene, nabata({{"light_samples", n(3)}}), 4, &next_events);
    ASSERT_EQ(result.maps.size(), 1U);
    EXPECT_EQ(result.maps.front().name, "nabata.normalization");
    for (std::size_t i = 0; i < next_events.sums().size(); ++i) {
        const double expected = next_events.sums()[i] / 4;
        EXPECT_GT(expected, 0);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(double{result.maps.front().image.rgb[3 * i + c]}, expected,
                        1e-5 * expected);
        }
    }
}

Image mean_of(const std::vector<Image>& images) {
    Image mean(kWidth, kHeight);
    for (const Image& image : images) {
        for (std::size_t i = 0; i < mean.rgb.size(); ++i) {
            mean.rgb[i] += image.rgb[i] / static_cast<float>(images.size());
        }
    }
    return mean;
}
void expect_same(const Image& a, const Image& b) {
    ASSERT_EQ(a.rgb.size(), b.rgb.size());
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        ASSERT_NEAR(a.rgb[i], b.rgb[i], 1e-5F * (1 + std::abs(a.rgb[i]))) << i;
    }
}

TEST(Direct, KeepsOrDropsThePassesItLearnedFromAndGoesOnWithNewNumbers) {
    const auto pass = [](const ParameterMap& parameters, std::int64_t i) {
        return render_with(veach_mis(), parameters, 1, nullptr, i).image;
    };
    const ParameterMap keep = nabata();
    const ParameterMap drop = nabata({{"nabata_keep", false}});
    expect_same(render_with(veach_mis(), keep, 3).image,
                mean_of({pass(keep, 0), pass(keep, 1), pass(keep, 2)}));
    expect_same(render_with(veach_mis(), drop, 3).image, mean_of({pass(keep, 1), pass(keep, 2)}));
    // With factors, a pass to learn P from is followed by one to learn factors from.
    ParameterMap factors = drop;
    factors.insert({{"factors", text("correction")},
                    {"correction_groups", text("hit")},
                    {"correction_keep", false}});
    const RenderResult result = render_with(veach_mis(), factors, 4);
    expect_same(result.image, mean_of({pass(factors, 2), pass(factors, 3)}));
    EXPECT_EQ(pass(factors, 1), pass(keep, 1));
    EXPECT_EQ(result.statistics.training_passes, 2);
    // The light samples of no two passes are the same.
    NextEvents first;
    NextEvents second;
    render_with(veach_mis(), drop, 1, &first, 0);
    render_with(veach_mis(), drop, 1, &second, 1);
    int n_same = 0;
    int n_lit = 0;
    for (std::size_t i = 0; i < first.sums().size(); ++i) {
        n_lit += first.sums()[i] > 0 ? 1 : 0;
        n_same += first.sums()[i] > 0 && first.sums()[i] == second.sums()[i] ? 1 : 0;
    }
    EXPECT_GT(n_lit, 100);
    EXPECT_EQ(n_same, 0);
}

TEST(Direct, LearnsBeforehandWhereThatIsAsked) {
    const RenderResult alone = render_with(veach_mis(), nabata({{"precompute", n(3)}}), 2);
    EXPECT_EQ(alone.statistics.precomputed_passes, 3);
    EXPECT_EQ(alone.statistics.training_passes, 0);
    EXPECT_NE(alone.image, render_with(veach_mis(), nabata(), 2).image);
    const RenderResult both = render_with(
        veach_mis(),
        nabata({{"precompute", n(3)}, {"factors", text("variance")}, {"nabata_keep", false}}), 2);
    EXPECT_EQ(both.statistics.precomputed_passes, 6);
    EXPECT_EQ(both.statistics.passes, 2);
}

// The mean squared difference of two seeds, over both.
double variance_of(const Scene& scene, const ParameterMap& parameters) {
    const Image a = render_with(scene, parameters, 8, nullptr, {}, 1).image;
    const Image b = render_with(scene, parameters, 8, nullptr, {}, 2).image;
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double mean = (double{a.rgb[i]} + double{b.rgb[i]}) / 2;
        const double difference = double{a.rgb[i]} - double{b.rgb[i]};
        sum += difference * difference / (mean * mean + 1e-4);
    }
    return sum;
}

TEST(Direct, HasLessVarianceWithMoreCandidates) {
    const auto variance = [](std::int64_t candidates) {
        return variance_of(veach_mis(), {{"candidates", candidates},
                                         {"bsdf_samples", n(0)},
                                         {"light_selection", text("area")}});
    };
    const double one = variance(1);
    const double four = variance(4);
    EXPECT_LT(four, 0.7 * one);
    EXPECT_LT(variance(32), 0.7 * four);
}

TEST(Direct, AllocatesNothingForACandidateOnceItIsWarm) {
    const ParameterMap parameters =
        nabata({{"light_samples", n(2)}, {"factors", text("correction")}});
    const auto count = [&](std::int64_t samples) {
        const std::int64_t before = test::n_allocations();
        render_with(gallery(), parameters, samples);
        return test::n_allocations() - before;
    };
    count(2);
    const double per_pass = static_cast<double>(count(16) - count(8)) / 8;
    EXPECT_LT(per_pass, 0.1 * kWidth * kHeight);
}

TEST(Direct, RefusesParametersThatCannotBe) {
    const auto refuses = [](const ParameterMap& parameters, const std::string& key,
                            const std::string& message) {
        try {
            find_method("direct").effective(parameters);
            ADD_FAILURE() << key;
        } catch (const ParameterError& e) {
            EXPECT_EQ(e.key(), key);
            EXPECT_THAT(e.what(), testing::HasSubstr(message));
        }
    };
    refuses({{"candidates", n(0)}}, "candidates", "candidates must lie between 1 and 1024");
    refuses({{"light_samples", n(1025)}}, "light_samples", "between 0 and 1024");
    refuses({{"bsdf_samples", n(-1)}}, "bsdf_samples", "between 0 and 1024");
    refuses({{"light_samples", n(0)}, {"bsdf_samples", n(0)}}, "light_samples", "nothing to do");
    refuses({{"resampled_density", text("nabatta")}}, "resampled_density",
            "unknown resampled density 'nabatta'; known: candidate nabata");
    refuses({{"light_selection", text("areas")}}, "light_selection", "known: uniform power area");
    refuses({{"factors", text("none+")}}, "factors", "unknown factor");
    refuses({{"mis", text("ballance")}}, "mis", "unknown MIS heuristic");
}

}  // namespace
}  // namespace misbench
