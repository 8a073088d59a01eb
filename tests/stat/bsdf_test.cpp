// Every material over the whole range of its parameters: what it evaluates and samples agree, is
// finite, reciprocal, the same for both transports, and no more than what comes in.
#include <gtest/gtest.h>

#include <array>

#include "renderer/base/error.h"
#include "renderer/scene/conductor_presets.h"
#include "renderer/scene/refraction.h"
#include "tests/support/materials.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

using test::MaterialRow;

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;

constexpr std::array kCosines = {1.0F, 0.7F, 0.3F, 0.05F, 0.01F, 1e-4F};
constexpr std::array kTransports = {Transport::Radiance, Transport::Importance};

// Calls with all rows, and all that they can be looked at from.
template <class Function>
void for_encounters(Function&& function) {
    for (const test::Rows* rows : {&test::detailed_rows(), &test::grid_rows()}) {
        for (const MaterialRow& row : *rows) {
            for (const bool inside : test::sides_of(row)) {
                for (const float cosine : kCosines) {
                    function(row, Encounter{.wo = test::direction(cosine), .inside = inside});
                }
            }
        }
    }
}

std::string place(const MaterialRow& row, const Encounter& e) {
    return row.name + " at cos " + std::to_string(e.wo.z) + (e.inside ? " from inside" : "");
}

Rng rng_of(int i) { return {12, static_cast<std::uint32_t>(i), 0}; }

// Directions at random, and where formulas divide by nothing.
std::vector<Vec3> directions(Vec3 wo) {
    std::vector<Vec3> result = {
        {-wo.x, -wo.y, wo.z}, {-wo.x, -wo.y, -wo.z}, wo, {wo.x, wo.y, -wo.z}};
    for (int i = 0; i < 20; ++i) {
        Rng rng = rng_of(i);
        const float phi = 2 * kPi * rng.uniform();
        const float z = 2 * rng.uniform() - 1;
        for (const float cosine : {z, std::copysign(1e-4F, z), std::copysign(1e-20F, z), 0.0F}) {
            result.push_back(test::direction(cosine, phi));
        }
    }
    return result;
}

bool is_finite_and_positive(Rgb color) {
    return std::isfinite(color.r + color.g + color.b) && color.r >= 0 && color.g >= 0 &&
           color.b >= 0;
}

TEST(Materials, AreFiniteAndNotNegativeAtAnyAngle) {
    for_encounters([](const MaterialRow& row, const Encounter& e) {
        for (const Vec3 wi : directions(e.wo)) {
            const BsdfValue value = test::evaluate(row.material, e, wi);
            ASSERT_TRUE(is_finite_and_positive(value.f_cos) && std::isfinite(value.pdf) &&
                        value.pdf >= 0)
                << place(row, e) << " to cos " << wi.z;
        }
    });
}

TEST(Materials, SampleWhatTheyEvaluate) {
    for_encounters([](const MaterialRow& row, const Encounter& radiance) {
        for (int i = 0; i < 100; ++i) {
            Encounter e = radiance;
            e.transport = kTransports[static_cast<std::size_t>(i) % 2];
            Rng rng = rng_of(i);
            const auto drawn = test::sample(row.material, e, rng);
            if (!drawn) continue;
            ASSERT_TRUE(is_finite_and_positive(drawn->weight)) << place(row, e);
            ASSERT_NEAR(length(drawn->wi), 1, 1e-5) << place(row, e);
            ASSERT_GT(drawn->pdf, 0);
            ASSERT_EQ(drawn->is_delta && drawn->pdf > 1, false);
            if (drawn->is_delta) continue;
            const BsdfValue value = test::evaluate(row.material, e, drawn->wi);
            ASSERT_EQ(value.pdf, drawn->pdf) << place(row, e);
            const auto f_cos = static_cast<double>(value.f_cos.g);
            ASSERT_NEAR(double{drawn->weight.g} * value.pdf, f_cos, 1e-6 * f_cos) << place(row, e);
            if (drawn->wi.z < 0) {
                ASSERT_EQ(drawn->eta, e.inside ? 1 / row.eta : row.eta) << place(row, e);
            }
        }
    });
}

TEST(Materials, SayWhichLobesTheyHave) {
    for_encounters([](const MaterialRow& row, const Encounter& e) {
        const Lobes known = lobes(row.material);
        for (int i = 0; i < 100; ++i) {
            Rng rng = rng_of(i);
            const auto drawn = test::sample(row.material, e, rng);
            if (!drawn) continue;
            ASSERT_TRUE((known & kTransmissiveLobe) || drawn->wi.z > 0) << place(row, e);
            ASSERT_TRUE(known & (drawn->is_delta ? kDeltaLobe : kDiffuseLobe | kGlossyLobe))
                << place(row, e);
        }
    });
}

// f(wo, wi).
float f_of(const MaterialRow& row, const Encounter& e, Vec3 wi) {
    return test::evaluate(row.material, e, wi).f_cos.g / std::abs(wi.z);
}

// How far off f may be as directions are floats: a narrow lobe is as steep as that.
float rounding_of_f(const MaterialRow& row, const Encounter& e, Vec3 wi) {
    const float f = f_of(row, e, wi);
    float rounding = 1e-4F * f + 1e-6F;
    for (const float sign : {-1.0F, 1.0F}) {
        const Vec3 ulp = {sign * 0x1p-23F, sign * 0x1p-24F, 0};
        rounding += std::abs(f_of(row, e, wi + ulp) - f);
        Encounter other = e;
        other.wo = e.wo + ulp;
        rounding += std::abs(f_of(row, other, wi) - f);
    }
    return rounding;
}

// Radiance: f(wo, wi) n_i² = f(wi, wo) n_o² with the refractive indices n, and either transport is
// the other one with the directions exchanged.                                     [Vea97 §5.2]
//
// [Vea97]  E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997.
TEST(Materials, AreReciprocal) {
    for_encounters([](const MaterialRow& row, const Encounter& e) {
        const float eta = e.inside ? 1 / row.eta : row.eta;
        for (int i = 0; i < 20; ++i) {
            Rng rng = rng_of(i);
            Vec3 wi = test::direction(2 * rng.uniform() - 1, 2 * kPi * rng.uniform());
            const auto drawn = test::sample(row.material, e, rng);
            if (drawn && !drawn->is_delta && i % 2) wi = drawn->wi;
            const test::Reversed back = test::reversed(e, wi);
            Encounter importance = back.e;
            importance.transport = Transport::Importance;
            const float scale = wi.z < 0 ? eta * eta : 1;
            const float f = f_of(row, e, wi);
            const float rounding = 4 * rounding_of_f(row, e, wi);
            ASSERT_NEAR(scale * f, f_of(row, back.e, back.wi), scale * rounding) << place(row, e);
            ASSERT_NEAR(f, f_of(row, importance, back.wi), rounding) << place(row, e);
        }
    });
}

TEST(Materials, ReachDeltaDirectionsBothWaysWithOneProbability) {
    for_encounters([](const MaterialRow& row, const Encounter& e) {
        for (int i = 0; i < 20; ++i) {
            Rng rng = rng_of(i);
            const auto there = test::sample(row.material, e, rng);
            if (!there || !there->is_delta) continue;
            const test::Reversed back = test::reversed(e, there->wi);
            std::optional<BsdfSample> again;
            for (int j = 0; j < 10'000 && !again; ++j) {
                Rng other = rng_of(j);
                again = test::sample(row.material, back.e, other);
                if (again && !(again->is_delta && (again->wi.z > 0) == (there->wi.z > 0)))
                    again.reset();
            }
            if (there->pdf < 1e-3) continue;
            ASSERT_TRUE(again) << place(row, e);
            ASSERT_NEAR(again->pdf, there->pdf, 1e-3) << place(row, e);
            ASSERT_NEAR(max_abs(again->wi - back.wi), 0, 1e-3) << place(row, e);
        }
    });
}

TEST(Materials, LetLightPassStraightOnWhereNoIndexChanges) {
    const std::array<Material, 3> materials = {DielectricMaterial({.eta = 1}),
                                               ThinDielectricMaterial({.eta = 1}),
                                               RoughDielectricMaterial({.eta = 1})};
    for (const Material& material : materials) {
        for (const float cosine : kCosines) {
            const Encounter e = {.wo = test::direction(cosine)};
            Rng rng = rng_of(0);
            const auto drawn = test::sample(material, e, rng);
            ASSERT_TRUE(drawn && drawn->is_delta && drawn->pdf == 1);
            EXPECT_LT(max_abs(drawn->wi + e.wo), 1e-6F);
            EXPECT_EQ(drawn->weight, kWhite);
        }
    }
}

// Of importance: what flux is, however much refraction concentrates radiance.
TEST(Materials, SendOnNoMoreThanComesIn) {
    int n_comparisons = 0;
    for_encounters([&](const MaterialRow&, const Encounter&) { ++n_comparisons; });
    const double level = test::sidak(kAlpha, n_comparisons);
    for_encounters([&](const MaterialRow& row, const Encounter& radiance) {
        Encounter e = radiance;
        e.transport = Transport::Importance;
        std::vector<double> weights;
        double sum = 0;
        for (int i = 0; i < 2000; ++i) {
            Rng rng = rng_of(i);
            const auto drawn = test::sample(row.material, e, rng);
            weights.push_back(drawn ? double{max_channel(drawn->weight)} : 0);
            sum += weights.back();
        }
        const double albedo = sum / static_cast<double>(weights.size());
        // Nor nothing: no row is that dark, and no lobe is that often below the horizon.
        EXPECT_TRUE(albedo > 0.02 || e.wo.z < 0.05F) << place(row, e) << ": " << albedo;
        const double max_albedo = row.max_albedo + (e.wo.z < 0.05F ? row.grazing_excess : 0);
        if (albedo > max_albedo) {
            EXPECT_GT(test::p_value_of_mean(weights, max_albedo), level)
                << place(row, e) << ": " << albedo;
        }
    });
}

TEST(ConductorPresets, AreFoundByName) {
    const ConductorPreset& gold = find_conductor_preset("Au");
    const Rgb reflectance = fresnel_conductor(1, gold.eta, gold.k);
    EXPECT_GT(reflectance.r, 0.95);
    EXPECT_LT(reflectance.b, 0.5);
    const ConductorPreset& mirror = find_conductor_preset("none");
    EXPECT_EQ(fresnel_conductor(0.3F, mirror.eta, mirror.k), kWhite);
    EXPECT_THROW(find_conductor_preset("Unobtainium"), ParameterError);
}

}  // namespace
}  // namespace misbench
