// The laboratory's integrals against closed forms, its weights against what they must be, and what
// its files may not say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/lab/plot.h"
#include "experiments/lab/quadrature.h"
#include "experiments/lab/study_file.h"
#include "renderer/base/error.h"
#include "tests/support/temporary_folder.h"

namespace misbench::lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr Domain kUnit{0, 1};

double integral_of(const std::function<double(double)>& f, const std::vector<double>& edges) {
    const Integrals integrals =
        integrate([&f](double x, std::span<double> values) { values[0] = f(x); }, 1, edges);
    EXPECT_TRUE(integrals.converged);
    return integrals.total(0);
}

Curve curve_of(Term term, Domain domain = kUnit) { return Curve({std::move(term)}, domain); }
Curve line(double from, double to) { return curve_of({Linear{kUnit, from, to}, 1, kUnit}); }
Density uniform(Domain support = kUnit) { return Density(curve_of({Uniform{kUnit}, 1, support})); }

Problem problem_of(Curve integrand, std::vector<Technique> techniques) {
    return {"p", "", kUnit, std::move(integrand), std::move(techniques)};
}

FixedWeights fixed(const Problem& problem, const HeuristicWeights& weights) {
    return fix_weights(problem, {"w", weights}, 1).value();
}

double variance_of(const Problem& problem, const HeuristicWeights& weights) {
    return exact_moments(problem, fixed(problem, weights).weigh).variance;
}

// --- quadrature ----------------------------------------------------------------------------------

TEST(LabQuadrature, EqualsClosedForms) {
    EXPECT_NEAR(integral_of([](double x) { return std::pow(x, 20); }, {0, 1}), 1.0 / 21, 1e-15);
    EXPECT_NEAR(integral_of([](double x) { return std::exp(-x); }, {0, 2}), 1 - std::exp(-2),
                1e-14);
    EXPECT_NEAR(integral_of([](double x) { return std::sqrt(x); }, {0, 1}), 2.0 / 3, 1e-10);
    EXPECT_NEAR(integral_of([](double x) { return 1e-4 / (1e-8 + x * x); }, {-1, 0, 1}),
                2 * std::atan(1e4), 1e-8);
}

TEST(LabQuadrature, FindsJumpsAndKinksThatNobodyNamed) {
    const double at = 1 / std::numbers::pi;
    EXPECT_NEAR(integral_of([at](double x) { return x < at ? 1 : 0; }, {0, 1}), at, 1e-9);
    EXPECT_NEAR(integral_of([at](double x) { return std::abs(x - at); }, {0, 1}),
                (at * at + (1 - at) * (1 - at)) / 2, 1e-10);
}

TEST(LabQuadrature, SaysThatAPoleHasNoIntegral) {
    const auto pole = [](double x, std::span<double> values) {
        values[0] = 1 / ((x - 0.3) * (x - 0.3));
    };
    EXPECT_FALSE(integrate(pole, 1, std::vector<double>{0, 1}).converged);
    const auto nan = [](double, std::span<double> values) { values[0] = std::nan(""); };
    EXPECT_FALSE(integrate(nan, 1, std::vector<double>{0, 1}).converged);
}

// --- curves --------------------------------------------------------------------------------------

std::vector<Term> every_shape(const Domain& domain) {
    return {{Uniform{domain}, 2, {0.25, 0.5}},
            {Linear{domain, 0.5, 3}, 1, domain},
            {Linear{domain, 0, 2}, 1, domain},
            {Gaussian{0.4, 0.07}, 1, domain},
            {Gaussian{-0.5, 0.4}, 3, {0.1, 1}},
            {Beta{domain, 2, 5}, 1, domain},
            {Beta{domain, 1, 1.5}, 1, domain},
            {Beta{domain, 3000, 1000}, 1, domain},
            {Table{{-0.5, 0.2, 0.7, 0.9}, {1, 0, 4, 0.5}}, 1, domain}};
}

TEST(LabCurve, HasTheIntegralThatQuadratureFinds) {
    for (const Domain domain : {kUnit, Domain{-0.5, 1.5}}) {
        std::vector<Term> all = every_shape(domain);
        std::vector<Curve> curves;
        for (const Term& term : all) curves.push_back(curve_of(term, domain));
        curves.emplace_back(std::move(all), domain);
        for (std::size_t i = 0; i < curves.size(); ++i) {
            const Curve& curve = curves[i];
            const std::vector<double> edges(curve.edges().begin(), curve.edges().end());
            EXPECT_NEAR(integral_of([&](double x) { return curve.value(x); }, edges),
                        curve.integral_to(domain.high), 1e-9)
                << "shape " << i;
        }
    }
}

TEST(LabDensity, IntegratesToOneAndHasItsQuantiles) {
    for (const Term& term : every_shape(kUnit)) {
        const Density density(curve_of(term));
        const std::vector<double> edges(density.edges().begin(), density.edges().end());
        EXPECT_NEAR(integral_of([&](double x) { return density.value(x); }, edges), 1, 1e-9);
        for (const double u : {1e-9, 0.01, 0.3, 0.5, 0.77, 0.999}) {
            const double x = density.quantile(u);
            EXPECT_NEAR(density.cumulative(x), u, 1e-12);
            EXPECT_GT(density.value(x), 0);
        }
    }
}

// --- moments -------------------------------------------------------------------------------------

// ∫ x dx = 1/2 with n uniform samples.
TEST(LabMoments, EqualTheClosedFormsOfEveryLayout) {
    for (const int n : {1, 2, 5}) {
        const auto moments = [n](Layout layout, int cells) {
            const Problem problem =
                problem_of(line(0, 1), {make_technique("t", uniform(), n, layout, cells)});
            return exact_moments(problem, only_technique(0));
        };
        const Moments independent = moments(Layout::Independent, 1);
        EXPECT_NEAR(independent.mean, 0.5, 1e-12);
        EXPECT_NEAR(independent.variance, 1.0 / 12 / n, 1e-12);
        EXPECT_NEAR(moments(Layout::Stratified, 1).variance, 1.0 / 12 / (n * n * n), 1e-12);
        for (const int m : {1, 3, 50}) {
            const double in_cell = 1.0 / 12 / (m * m);
            EXPECT_NEAR(moments(Layout::Shared, m).variance, in_cell / n + 1.0 / 12 - in_cell,
                        1e-12)
                << m;
        }
    }
}

TEST(LabMoments, TellBiasApart) {
    const Problem problem = problem_of(
        line(1, 1), {make_technique("half", uniform({0, 0.5}), 3, Layout::Independent, 1)});
    const Moments moments = exact_moments(problem, only_technique(0));
    EXPECT_NEAR(moments.mean, 0.5, 1e-12);
    EXPECT_EQ(moments.variance, 0);
    EXPECT_EQ(problem.integral(), 1);
}

// p_1 = 1 and p_2 = 2x with f = x²: ∫ w² f² / q = ∫ x⁴ / (1 + 2x) dx for both together, and the
// means of the two are ∫ x² / (1 + 2x) dx and 1/3 minus that.
TEST(LabMoments, OfTheBalanceHeuristicEqualAClosedForm) {
    const Problem problem =
        problem_of(curve_of({Table{{0, 1}, {0, 1}}, 1, kUnit}),
                   {make_technique("one", uniform(), 1, Layout::Independent, 1),
                    make_technique("two", Density(line(0, 1)), 1, Layout::Independent, 1)});
    // Here f = x: ∫ x² / (1 + 2x) = log(3) / 8, ∫ x / (1 + 2x) = 1/2 - log(3) / 4.
    const double second = std::log(3) / 8;
    const double mean_1 = 0.5 - std::log(3) / 4;
    const double mean_2 = 0.5 - mean_1;
    EXPECT_NEAR(variance_of(problem, {}), second - mean_1 * mean_1 - mean_2 * mean_2, 1e-12);
}

// --- weights -------------------------------------------------------------------------------------

Problem stratified_beside_independent() {
    return problem_of(line(0, 1), {make_technique("iid", uniform(), 4, Layout::Independent, 1),
                                   make_technique("cut", uniform(), 4, Layout::Stratified, 1)});
}

TEST(LabWeights, VarianceFactorsGiveTheOptimalConstantsForEqualDensities) {
    const Problem problem = stratified_beside_independent();
    const double v_iid = 1.0 / 48;
    const double v_cut = 1.0 / 768;
    const double optimum = 1 / (1 / v_iid + 1 / v_cut);
    EXPECT_NEAR(variance_of(problem, {.variance = MomentsFrom{}}), optimum, 1e-12);
    EXPECT_NEAR(variance_of(problem, {.heuristic = "constant", .inverse_variance = MomentsFrom{}}),
                optimum, 1e-12);
    // The pilot's moments are near the exact ones, and its weights so near the optimum's flat top.
    const double from_pilot = variance_of(problem, {.variance = MomentsFrom{200}});
    EXPECT_GT(from_pilot, optimum);
    EXPECT_LT(from_pilot, 1.1 * optimum);
}

TEST(LabWeights, ATechniqueWithoutVarianceHasAllOfTheInverseVariances) {
    const Problem problem = problem_of(
        line(0, 1), {make_technique("iid", uniform(), 1, Layout::Independent, 1),
                     make_technique("exact", Density(line(0, 1)), 1, Layout::Independent, 1)});
    const FixedWeights weights =
        fixed(problem, {.heuristic = "constant", .inverse_variance = MomentsFrom{}});
    EXPECT_THAT(weights.factors, ElementsAre(0, 1));
}

TEST(LabWeights, PopovCountsSharedSamplesOnce) {
    const Problem problem =
        problem_of(line(0, 1), {make_technique("iid", uniform(), 4, Layout::Independent, 1),
                                make_technique("shared", uniform(), 8, Layout::Shared, 1000)});
    EXPECT_THAT(fixed(problem, {.popov = true}).factors, ElementsAre(1, 0.125));
    EXPECT_LT(variance_of(problem, {.popov = true}), variance_of(problem, {}));
}

TEST(LabWeights, CorrectionTakesTheBestOfAllCombinations) {
    const Problem problem = problem_of(
        line(0.2, 1), {make_technique("iid", uniform(), 2, Layout::Independent, 1),
                       make_technique("left", Density(line(1.5, 0.5)), 1, Layout::Independent, 1),
                       make_technique("shared", uniform(), 3, Layout::Shared, 5)});
    const HeuristicWeights with{.correction = CandidateGrid{.candidates = 6}};
    const std::vector<double> chosen = fixed(problem, with).factors;
    double best = variance_of(problem, {});
    std::vector<double> best_factors{1, 1, 1};
    for (int i = 0; i < 216; ++i) {
        const std::vector<double> factors{-1 + 0.4 * (i / 36), -1 + 0.4 * (i / 6 % 6),
                                          -1 + 0.4 * (i % 6)};
        const Moments moments = exact_moments(
            problem, [&](double, double f, std::span<const double> q, std::span<double> weighted) {
                double sum = 0;
                for (std::size_t t = 0; t < 3; ++t) sum += factors[t] * q[t];
                for (std::size_t t = 0; t < 3; ++t) weighted[t] = factors[t] * q[t] / sum * f;
            });
        if (moments.variance < best * (1 - 1e-9)) {
            best = moments.variance;
            best_factors = factors;
        }
    }
    EXPECT_NEAR(variance_of(problem, with), best, 1e-9);
    EXPECT_LT(best, 0.9 * variance_of(problem, {}));
    // Factors count up to a common one.
    for (std::size_t t = 0; t < 3; ++t) {
        EXPECT_NEAR(chosen[t] * best_factors[0], best_factors[t] * chosen[0], 1e-9);
    }
}

TEST(LabWeights, CorrectionKeepsFixedFactorsAndNeverIsWorse) {
    const Problem problem = stratified_beside_independent();
    const FixedWeights weights =
        fixed(problem, {.correction = CandidateGrid{.candidates = 2, .fixed = {"cut"}}});
    EXPECT_THAT(weights.factors, ElementsAre(1, 1));
}

TEST(LabWeights, CorrectionNeverTakesFactorsThatLeaveAPlaceUnsampled) {
    const Problem problem = problem_of(
        line(1, 2), {make_technique("left", uniform({0, 0.6}), 2, Layout::Independent, 1),
                     make_technique("right", uniform({0.4, 1}), 1, Layout::Independent, 1)});
    for (const MomentsFrom& from : {MomentsFrom{}, MomentsFrom{50}}) {
        const CandidateGrid grid{.low = 0, .high = 1, .candidates = 3, .moments = from};
        const FixedWeights weights = fixed(problem, {.correction = grid});
        EXPECT_THAT(weights.factors, testing::Each(testing::Gt(0)));
        EXPECT_NEAR(exact_moments(problem, weights.weigh).mean, problem.integral(), 1e-9);
    }
}

TEST(LabWeights, OptimalOnesLeaveNoVarianceToASumOfDensities) {
    const Problem problem = problem_of(
        line(3, 2), {make_technique("iid", uniform(), 2, Layout::Independent, 1),
                     make_technique("line", Density(line(0, 1)), 1, Layout::Independent, 1)});
    const auto weights = fix_weights(problem, {"o", OptimalWeights{}}, 1);
    EXPECT_LT(exact_moments(problem, weights->weigh).variance, 1e-12);
}

TEST(LabWeights, SumToOneWhereTheIntegrandIsSampled) {
    const Problem problem = stratified_beside_independent();
    for (const Weighting& weighting :
         {Weighting{"h", HeuristicWeights{.variance = MomentsFrom{}}},
          Weighting{"o", OptimalWeights{}}, Weighting{"1", OneTechnique{"cut"}}}) {
        const auto weights = fix_weights(problem, weighting, 1);
        for (const double x : {0.01, 0.3, 0.99}) {
            const std::vector<double> w = weights_at(problem, *weights, x).value();
            EXPECT_NEAR(w[0] + w[1], 1, 1e-12);
        }
        EXPECT_FALSE(weights_at(problem, *weights, 0));  // f(0) = 0
    }
}

// --- files ---------------------------------------------------------------------------------------

constexpr const char* kFile = R"(name: a
runs: 10
weights:
  balance: {heuristic: balance}
  progressive: {optimal: progressive, iterations: 3}
problems:
  p:
    integrand: {shape: linear, from: 0, to: 1}
    techniques:
      one: {density: {shape: uniform}, samples: 2}
      two: {density: [{shape: beta, a: 2, b: 1}], samples: 4, layout: shared, cells: 8}
    expect:
      - {claim: it <is>, less: [progressive, balance], factor: 0.001}
      - {claim: it is not, equal: [progressive, balance], within: 1e-9, note: because}
)";

Study read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    const TemporaryFolder folder;
    return read_study(folder.write("lab.yaml", text), overrides);
}

TEST(LabFile, IsReadAndExamined) {
    const Study study = read(kFile, {"seed=7", "problems.p.techniques.one.samples=3"});
    EXPECT_EQ(study.seed, 7);
    ASSERT_EQ(study.cases.size(), 1U);
    const Case& one = study.cases[0];
    EXPECT_EQ(one.problem.techniques[0].samples, 3);
    EXPECT_EQ(one.problem.techniques[1].n_cells(), 8U);
    const CaseOutcome outcome = examine(one, study.seed, study.runs);
    EXPECT_NEAR(outcome.integral, 0.5, 1e-12);
    EXPECT_TRUE(outcome.outcomes[0].exact);
    EXPECT_FALSE(outcome.outcomes[1].exact);
    EXPECT_TRUE(outcome.outcomes[1].sampled_variance);
    EXPECT_TRUE(outcome.verdicts[0].holds);
    EXPECT_FALSE(outcome.verdicts[1].holds);
}

TEST(LabFile, WithoutRunsHasNothingSampled) {
    const Study study = read(kFile, {"runs=0"});
    const CaseOutcome outcome = examine(study.cases[0], 1, 0);
    EXPECT_FALSE(outcome.outcomes[0].sampled_variance);
    EXPECT_EQ(outcome.outcomes[0].error_ratio, 1);
    EXPECT_FALSE(outcome.outcomes[1].error);
    EXPECT_EQ(outcome.verdicts[0].found, "not sampled");
}

TEST(LabFile, IsDrawnAsOneSvgWithTextAsText) {
    const Study study = read(kFile, {"problems={\"a<b\": {integrand: {shape: uniform}, "
                                     "techniques: {t: {density: {shape: uniform}}}}}"});
    const std::string svg = to_svg(study, {examine(study.cases[0], 1, 10)});
    for (const char* text : {"<svg ", ">a&lt;b<", ">balance<", "</svg>"}) {
        EXPECT_NE(svg.find(text), std::string::npos) << text;
    }
    // Without an error of the balance heuristic there is no ratio to it.
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(LabFile, ErrorsNameThePlaceInOneLine) {
    const std::map<std::string, std::string> wrong{
        {"runs=2", "runs must be 0 or at least 3"},
        {"sed=2", "unknown key 'sed'"},
        {"weights.balance.heuristic=ballance", "unknown MIS heuristic 'ballance'"},
        {"weights.balance.iterations=3", "'iterations'"},
        {"weights.progressive.iterations=0", "iterations"},
        {"weights.progressive={optimal: direct}", "require it"},
        {"weights.balance={only: three}", "unknown technique 'three'"},
        {"weights.balance={variance: {pilot: 1}}", "pilot"},
        {"weights.balance={correlation: yes}", "unknown correlation 'yes'; known: popov"},
        {"weights.balance={correction: {candidates: 1}}", "candidates"},
        {"weights.balance={correction: {candidates: 1000, low: 2}}", "low must be below high"},
        {"weights.balance={correction: {fixed: x}}", "unknown technique 'x'"},
        {"problems={}", "problems must not be empty"},
        {"problems.p.domain=[1, 0]", "domain must be [low, high]"},
        {"problems.p.integrand={shape: sine}", "unknown shape 'sine'; known: uniform linear"},
        {"problems.p.integrand={shape: uniform, mean: 1}", "unknown key 'mean'"},
        {"problems.p.integrand={shape: gaussian, mean: 1, deviation: 0}", "deviation must be"},
        {"problems.p.integrand={shape: table, x: [0, 0], y: [1, 1]}", "must grow"},
        {"problems.p.integrand={shape: table, x: [0, 1], y: [1]}", "as many x as y"},
        {"problems.p.integrand={shape: uniform, support: [0, 2]}", "support must be in"},
        {"problems.p.techniques.one.density={shape: linear, from: -1, to: 1}", "below 0"},
        {"problems.p.techniques.one.density={shape: uniform, weight: 0}", "above 0 somewhere"},
        {"problems.p.techniques.one.samples=0", "samples"},
        {"problems.p.techniques.one={density: {shape: uniform}, samples: 64, layout: stratified}",
         "at most 64 techniques and strata"},
        {"problems.p.techniques.one.layout=shared", "which requires it"},
        {"problems.p.techniques.one.layout=sobol", "unknown layout 'sobol'; known: independent"},
        {"problems.p.expect=[{claim: x}]", "has one of: less equal less_weight negative"},
        {"problems.p.expect=[{claim: x, less: [a, b]}]", "unknown weights 'a'"},
        {"problems.p.expect=[{claim: x, less: [balance]}]", "a list of two"},
        {"problems.p.expect=[{claim: x, negative: progressive}]", "unknown weights 'progressive'"},
        {"problems.p.expect=[{claim: x, negative: balance, at: 1}]", "unknown key 'at'"},
    };
    for (const auto& [assignment, message] : wrong) {
        try {
            read(kFile, {assignment});
            ADD_FAILURE() << assignment;
        } catch (const Error& e) {
            const std::string text = e.what();
            EXPECT_EQ(e.code(), Errc::InvalidArgument);
            EXPECT_THAT(text, HasSubstr(message)) << assignment;
            EXPECT_EQ(std::ranges::count(text, '\n'), 0) << text;
        }
    }
    EXPECT_THROW(read_study("/nowhere.yaml", {}), Error);
}

}  // namespace
}  // namespace misbench::lab
