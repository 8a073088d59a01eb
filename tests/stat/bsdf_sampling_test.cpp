// Every material is sampled with the density that it states: χ² over the whole sphere, delta lobes
// apart.
#include <gtest/gtest.h>

#include <array>

#include "renderer/scene/refraction.h"
#include "tests/support/materials.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

using test::MaterialRow;

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;

constexpr std::array kCosines = {1.0F, 0.5F, 0.05F};
constexpr int kSamples = 100'000;

// Bins of one hemisphere of wi; first the reflections', then the transmissions'.
constexpr std::size_t kBinsA = 16;
constexpr std::size_t kBinsB = 32;
constexpr std::size_t kBins = kBinsA * kBinsB;
enum SpecialBin : std::size_t { kDeltaReflection = 2 * kBins, kDeltaTransmission, kNothing };

// Where directions are binned: the row's coordinates seen from wo.
struct Chart {
    Vec3 wo;
    Vec2 lobe;
    float eta;
};

// Coordinates (a, b) in [0, 1)² of a direction in its hemisphere.
struct Coordinates {
    double a = 0;
    double b = 0;
};
double fraction_of_turn(float y, float x) {
    const double turn = std::atan2(double{y}, double{x}) / (2 * M_PI);
    return turn < 0 ? turn + 1 : turn;
}

Coordinates coordinates_of(const Chart& chart, Vec3 wi) {
    if (chart.lobe == Vec2{}) return {double{std::abs(wi.z)}, fraction_of_turn(wi.y, wi.x)};
    // Slopes of the half vector in units of the lobe, r² = x² + y², a = r² / (1 + r²).
    const Vec3 h = wi.z > 0 ? chart.wo + wi : chart.wo + chart.eta * wi;
    const float x = h.x / h.z / chart.lobe.x;
    const float y = h.y / h.z / chart.lobe.y;
    const double r2 = double{x} * double{x} + double{y} * double{y};
    return {r2 / (1 + r2), fraction_of_turn(y, x)};
}

std::size_t bin_of(const Chart& chart, Vec3 wi) {
    const Coordinates at = coordinates_of(chart, wi);
    const auto a = std::min(static_cast<std::size_t>(at.a * kBinsA), kBinsA - 1);
    const auto b = static_cast<std::size_t>(at.b * kBinsB) % kBinsB;
    return (wi.z > 0 ? 0 : kBins) + a * kBinsB + b;
}

// The direction at (a, b) and the solid angle that a unit of da db covers there; 0: no direction.
struct Inverse {
    Vec3 wi;
    double solid_angle = 0;
};
Inverse direction_at(const Chart& chart, Coordinates at, bool reflects) {
    if (chart.lobe == Vec2{}) {
        const Vec3 w =
            test::direction(static_cast<float>(at.a), static_cast<float>(2 * M_PI * at.b));
        return {{w.x, w.y, reflects ? w.z : -w.z}, 2 * M_PI};
    }
    const double r2 = at.a / (1 - at.a);
    const double x = double{chart.lobe.x} * std::sqrt(r2) * std::cos(2 * M_PI * at.b);
    const double y = double{chart.lobe.y} * std::sqrt(r2) * std::sin(2 * M_PI * at.b);
    const double z = 1 / std::sqrt(1 + x * x + y * y);
    const Vec3 h = {static_cast<float>(x * z), static_cast<float>(y * z), static_cast<float>(z)};
    const double cos_o = double{dot(chart.wo, h)};
    if (cos_o <= 0) return {};
    // dω_h = h.z³ ds, ds = α_x α_y dt, dt = π (1 + r²)² da db.
    const double of_half =
        z * z * z * double{chart.lobe.x} * double{chart.lobe.y} * M_PI * (1 + r2) * (1 + r2);
    if (reflects) return {mirrored(chart.wo, h), 4 * cos_o * of_half};
    const auto wi = refracted(chart.wo, h, chart.eta);
    if (!wi) return {};
    // dω_i = dω_h (wo·h + η wi·h)² / (η² |wi·h|).                           [WMLT07 (17)]
    const double eta = double{chart.eta};
    const double cos_i = double{-dot(*wi, h)};
    const double sum = cos_o - eta * cos_i;
    return {*wi, of_half * sum * sum / (eta * eta * cos_i)};
}

// ∫ p over one bin by midpoints, in t with a = a1 - (a1 - a0) t⁴: dense at the end, where the
// lobe's coordinates squeeze all steep slopes into the last bin.
double bin_probability(const MaterialRow& row, const Encounter& e, const Chart& chart,
                       std::size_t bin) {
    constexpr std::size_t kSubB = 12;
    const bool reflects = bin < kBins;
    const std::size_t bin_a = bin % kBins / kBinsB;
    const std::size_t bin_b = bin % kBinsB;
    const std::size_t n_sub_a = bin_a + 1 == kBinsA ? 192 : 48;
    double sum = 0;
    for (std::size_t i = 0; i < n_sub_a; ++i) {
        const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(n_sub_a);
        const double a = (static_cast<double>(bin_a) + 1 - t * t * t * t) / kBinsA;
        for (std::size_t j = 0; j < kSubB; ++j) {
            const double b = (static_cast<double>(bin_b * kSubB + j) + 0.5) / (kBinsB * kSubB);
            const Inverse at = direction_at(chart, {a, b}, reflects);
            if (at.solid_angle == 0 || (at.wi.z > 0) != reflects) continue;
            sum += 4 * t * t * t * test::evaluate(row.material, e, at.wi).pdf * at.solid_angle;
        }
    }
    return sum / static_cast<double>(n_sub_a * kSubB * kBins);
}

// Expected counts of every bin but the special ones.
std::vector<double> expected_counts(const MaterialRow& row, const Encounter& e,
                                    const Chart& chart) {
    std::vector<double> expected(2 * kBins, 0);
    const bool transmits = lobes(row.material) & kTransmissiveLobe;
    for (std::size_t bin = 0; bin < (transmits ? 2 * kBins : kBins); ++bin) {
        expected[bin] = kSamples * bin_probability(row, e, chart, bin);
    }
    return expected;
}

// The p-value of the samples having the density. A delta lobe's probability is the one that its
// samples state.
double p_value_of_samples(const MaterialRow& row, const Encounter& e) {
    const Chart chart = {e.wo, row.lobe, e.inside ? 1 / row.eta : row.eta};
    std::vector<double> counts(kNothing + 1, 0);
    std::vector<double> expected = expected_counts(row, e, chart);
    expected.resize(kNothing, 0);
    for (int i = 0; i < kSamples; ++i) {
        Rng rng(11, static_cast<std::uint32_t>(i), 0);
        const auto drawn = test::sample(row.material, e, rng);
        if (!drawn) {
            ++counts[kNothing];
        } else if (drawn->is_delta) {
            const auto bin = drawn->wi.z > 0 ? kDeltaReflection : kDeltaTransmission;
            ++counts[bin];
            expected[bin] = kSamples * drawn->pdf;
        } else {
            ++counts[bin_of(chart, drawn->wi)];
        }
    }
    double total = 0;
    for (const double n : expected) total += n / kSamples;
    EXPECT_LE(total, 1 + 2e-3) << "the density integrates to at most one: " << row.name;
    expected.push_back(std::max(0.0, kSamples * (1 - total)));
    return test::p_value_of_counts(counts, expected);
}

TEST(Materials, AreSampledWithTheirDensity) {
    std::size_t n_comparisons = 0;
    for (const MaterialRow& row : test::detailed_rows()) {
        n_comparisons += test::sides_of(row).size() * kCosines.size();
    }
    const double level = test::sidak(kAlpha, static_cast<int>(n_comparisons));
    for (const MaterialRow& row : test::detailed_rows()) {
        for (const bool inside : test::sides_of(row)) {
            for (const float cosine : kCosines) {
                const Encounter e = {.wo = test::direction(cosine), .inside = inside};
                EXPECT_GT(p_value_of_samples(row, e), level)
                    << row.name << " at cos " << cosine << (inside ? " from inside" : "");
            }
        }
    }
}

}  // namespace
}  // namespace misbench
