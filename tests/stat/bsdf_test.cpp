// Every material: samples against density, energy, reciprocity. A new material is a row of
// kMaterials.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "renderer/base/rng.h"
#include "renderer/math/warp.h"
#include "renderer/scene/ggx.h"
#include "renderer/scene/material.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;

struct Row {
    const char* name;
    Material material;
    // Alphas of the lobe in whose half-vector coordinates directions are binned; 0 bins directions
    // themselves. A narrow lobe is smooth only in its own coordinates.
    Vec2 lobe;
    // The largest reflectance the model may have: 1 for a microfacet lobe alone. The rough diffuse
    // lobe with retro-reflection does not conserve energy; a white one reaches 1.53 at cos 0.05.
    double max_albedo;
};

GenericMaterial generic(float roughness, float metallic, float ior = 1.45F, float anisotropic = 0) {
    return GenericMaterial({.base_color = {1, 1, 1},
                            .roughness = roughness,
                            .anisotropic = anisotropic,
                            .ior = ior,
                            .metallic = metallic});
}

const std::vector<Row>& rows() {
    static const std::vector<Row> kRows = {
        {"diffuse", DiffuseMaterial{{1, 1, 1}}, {}, 1},
        {"metal_rough", generic(1, 1), {}, 1},
        {"metal_glossy", generic(0.3F, 1), {0.09F, 0.09F}, 1},
        {"metal_smooth", generic(0.1F, 1), {0.01F, 0.01F}, 1},
        {"metal_mirror", generic(0.01F, 1), {1e-3F, 1e-3F}, 1},
        {"metal_anisotropic", generic(0.5F, 1, 1.45F, 0.9F), {0.79F, 0.079F}, 1},
        {"plastic_rough", generic(1, 0), {}, 1.53},
        {"plastic_half", generic(0.5F, 0), {}, 1.53},
        {"half_metal", generic(0.625F, 0.55F), {}, 1.53},
        {"high_ior", generic(0.4F, 0.2F, 3), {}, 1.53},
    };
    return kRows;
}
const std::array kCosines = {1.0F, 0.7F, 0.3F, 0.05F};

Vec3 direction(float cos_theta, float phi = 0.4F) {
    const float sin_theta = std::sqrt(1 - cos_theta * cos_theta);
    return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
}

BsdfValue evaluate(const Material& material, Vec3 wo, Vec3 wi) {
    return std::visit([&](const auto& m) { return m.evaluate(wo, wi); }, material);
}
std::optional<BsdfSample> sample(const Material& material, Vec3 wo, Rng& rng) {
    const float lobe = rng.uniform();
    const float u = rng.uniform();
    const BsdfRandom random{lobe, {u, rng.uniform()}};
    return std::visit([&](const auto& m) { return m.sample(wo, random); }, material);
}

// Coordinates (a, b) in [0, 1)² of a direction and the area of the sphere that da db covers.
struct Binned {
    double a = 0;
    double b = 0;
};
double fraction_of_turn(float y, float x) {
    const double turn = std::atan2(double{y}, double{x}) / (2 * M_PI);
    return turn < 0 ? turn + 1 : turn;
}

Binned to_bin(Vec3 wo, Vec3 wi, Vec2 lobe) {
    if (lobe == Vec2{}) return {std::min(double{wi.z}, 1 - 1e-9), fraction_of_turn(wi.y, wi.x)};
    // Slopes of the half vector in units of the lobe, r² = x² + y², a = r² / (1 + r²).
    const Vec3 h = normalized(wo + wi);
    const float x = h.x / h.z / lobe.x;
    const float y = h.y / h.z / lobe.y;
    const double r2 = double{x} * double{x} + double{y} * double{y};
    return {r2 / (1 + r2), fraction_of_turn(y, x)};
}

// The direction at (a, b) and the solid angle that a unit of da db covers there.
struct Inverse {
    Vec3 wi;
    double solid_angle;
};
Inverse from_bin(Vec3 wo, double a, double b, Vec2 lobe) {
    if (lobe == Vec2{}) {
        return {direction(static_cast<float>(a), static_cast<float>(2 * M_PI * b)), 2 * M_PI};
    }
    const double r2 = a / (1 - a);
    const double x = double{lobe.x} * std::sqrt(r2) * std::cos(2 * M_PI * b);
    const double y = double{lobe.y} * std::sqrt(r2) * std::sin(2 * M_PI * b);
    const double z = 1 / std::sqrt(1 + x * x + y * y);
    const Vec3 h = {static_cast<float>(x * z), static_cast<float>(y * z), static_cast<float>(z)};
    const double cos_half = double{dot(wo, h)};
    // dω_i = 4 |wo·h| dω_h, dω_h = h.z³ ds, ds = α_x α_y dt, dt = π (1 + r²)² da db.
    const double solid_angle = 4 * std::abs(cos_half) * z * z * z * double{lobe.x} *
                               double{lobe.y} * M_PI * (1 + r2) * (1 + r2);
    return {2 * static_cast<float>(cos_half) * h - wo, cos_half > 0 ? solid_angle : 0};
}

constexpr std::size_t kBinsA = 16;
constexpr std::size_t kBinsB = 32;
constexpr std::size_t kSub = 64;  // midpoints a bin and axis
constexpr int kSamples = 200'000;

// ∫ p over one bin by midpoints, in t with a = a1 - (a1 - a0) t⁴: dense at the end, where the
// lobe's coordinates squeeze all steep slopes into the last bin.
double bin_probability(const Row& row, Vec3 wo, std::size_t bin_a, std::size_t bin_b) {
    double sum = 0;
    for (std::size_t i = 0; i < kSub; ++i) {
        const double t = (static_cast<double>(i) + 0.5) / kSub;
        const double a = (static_cast<double>(bin_a) + 1 - t * t * t * t) / kBinsA;
        for (std::size_t j = 0; j < kSub; ++j) {
            const double b = (static_cast<double>(bin_b * kSub + j) + 0.5) / (kBinsB * kSub);
            const Inverse at = from_bin(wo, a, b, row.lobe);
            if (at.solid_angle == 0 || at.wi.z <= 0) continue;
            sum += 4 * t * t * t * evaluate(row.material, wo, at.wi).pdf * at.solid_angle;
        }
    }
    return sum / (kSub * kSub * kBinsA * kBinsB);
}

// Expected counts of every bin, and of samples that carry nothing.
std::vector<double> expected_counts(const Row& row, Vec3 wo) {
    std::vector<double> expected;
    double total = 0;
    for (std::size_t bin = 0; bin < kBinsA * kBinsB; ++bin) {
        const double p = bin_probability(row, wo, bin / kBinsB, bin % kBinsB);
        expected.push_back(kSamples * p);
        total += p;
    }
    EXPECT_LE(total, 1 + 1e-3) << "the density integrates to at most one";
    expected.push_back(std::max(0.0, kSamples * (1 - total)));
    return expected;
}

class EveryMaterial : public testing::TestWithParam<std::size_t> {
 protected:
    const Row& row_ = rows()[GetParam()];
};

TEST_P(EveryMaterial, IsSampledWithItsDensity) {
    const double level = test::sidak(kAlpha, static_cast<int>(rows().size() * kCosines.size()));
    for (const float cosine : kCosines) {
        const Vec3 wo = direction(cosine);
        std::vector<double> counts(kBinsA * kBinsB + 1, 0);
        for (int i = 0; i < kSamples; ++i) {
            Rng rng(11, static_cast<std::uint32_t>(i), 0);
            const auto drawn = sample(row_.material, wo, rng);
            if (!drawn) {
                ++counts.back();
                continue;
            }
            const BsdfValue value = evaluate(row_.material, wo, drawn->wi);
            ASSERT_EQ(value.pdf, drawn->pdf);
            const Binned at = to_bin(wo, drawn->wi, row_.lobe);
            const auto a = static_cast<std::size_t>(at.a * kBinsA);
            const auto b = static_cast<std::size_t>(at.b * kBinsB) % kBinsB;
            ++counts[std::min<std::size_t>(a, kBinsA - 1) * kBinsB + b];
        }
        EXPECT_GT(test::p_value_of_counts(counts, expected_counts(row_, wo)), level)
            << row_.name << " at cos " << cosine;
    }
}

TEST_P(EveryMaterial, ReflectsNoMoreThanItsModelMay) {
    for (const float cosine : kCosines) {
        const Vec3 wo = direction(cosine);
        double albedo = 0;
        constexpr int kN = 100'000;
        for (int i = 0; i < kN; ++i) {
            Rng rng(12, static_cast<std::uint32_t>(i), 0);
            if (const auto drawn = sample(row_.material, wo, rng)) {
                ASSERT_TRUE(std::isfinite(drawn->weight.r) && drawn->weight.r >= 0);
                albedo += double{drawn->weight.g} / kN;
            }
        }
        // The weights lie near one, so that 1e5 of them have a mean well within 1 %.
        EXPECT_LE(albedo, row_.max_albedo + 0.01) << row_.name << " at cos " << cosine;
        EXPECT_GT(albedo, 0.2) << row_.name << " at cos " << cosine;
    }
}

TEST_P(EveryMaterial, IsReciprocal) {
    std::mt19937 generator(13);
    std::uniform_real_distribution<float> uniform(0.02F, 1);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 wo = direction(uniform(generator), 6 * uniform(generator));
        const Vec3 wi = direction(uniform(generator), 6 * uniform(generator));
        const float there = evaluate(row_.material, wo, wi).f_cos.r / wi.z;
        const float back = evaluate(row_.material, wi, wo).f_cos.r / wo.z;
        ASSERT_NEAR(there, back, 2e-4F * std::max(there, 1e-3F)) << row_.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Table, EveryMaterial, testing::Range(std::size_t{0}, rows().size()),
                         [](const auto& test) { return std::string(rows()[test.param].name); });

}  // namespace
}  // namespace misbench
