// Intervals, tails and adjusted p values by simulation without rendering: the tables of
// bootstrap.h, tail.h and multiplicity.h. Every test has fixed seeds. An interval is said to hold
// the truth when it does so in 93 to 97 % of the experiments.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "experiments/statistics/bootstrap.h"
#include "experiments/statistics/multiplicity.h"
#include "experiments/statistics/power.h"
#include "experiments/statistics/tail.h"

namespace misbench {
namespace {

using Values = std::vector<double>;

// Errors of seeds: lognormal, and a share of them that many times larger.
struct Errors {
    double spread = 0;
    double share = 0;
    double times = 1;

    double mean() const { return std::exp(spread * spread / 2) * (1 + share * (times - 1)); }
    Values draw(std::mt19937_64& random, int n) const {
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> uniform;
        Values values;
        for (int i = 0; i < n; ++i) {
            const double error = std::exp(spread * normal(random));
            values.push_back(uniform(random) < share ? error * times : error);
        }
        return values;
    }
};
constexpr Errors kSpiky{.spread = 0.2, .share = 0.2, .times = 5};

bool holds(const std::optional<Estimate>& estimate, double truth) {
    return estimate && estimate->interval && estimate->interval->low <= truth &&
           truth <= estimate->interval->high;
}

double coverage(int n_trials, const auto& is_held) {
    std::mt19937_64 random(20250301);
    int n = 0;
    for (int trial = 0; trial < n_trials; ++trial) n += is_held(random) ? 1 : 0;
    return static_cast<double>(n) / n_trials;
}

double coverage_of_ratio(int n_trials, int n, const Errors& a, const Errors& b,
                         const auto& interval_of) {
    return coverage(n_trials, [&](std::mt19937_64& random) {
        const Values of_a = a.draw(random, n);
        const Values of_b = b.draw(random, n);
        return holds(interval_of(of_a, of_b), a.mean() / b.mean());
    });
}

void expect_95(double share, const std::string& what) {
    EXPECT_GE(share, 0.93) << what;
    EXPECT_LE(share, 0.97) << what;
}

struct Pair {
    Errors a;
    Errors b;
};
// Where the header says that intervals hold what they promise.
const std::vector<Pair> kCalm = {{{0.2}, {0.2}}, {{0.5}, {0.5}}, {{0.2}, {0.5}}};

std::string name_of(const Pair& pair, int n) {
    return std::to_string(pair.a.spread) + "/" + std::to_string(pair.b.spread) +
           " n = " + std::to_string(n);
}

const auto kDelta = [](const Values& a, const Values& b) { return estimate_ratio(a, b); };
const auto kBootstrap = [](const Values& a, const Values& b) { return bootstrap_ratio(a, b); };

TEST(Coverage, OfTheDeltaMethodIs95PercentForSpreadsUpToOneHalf) {
    for (const Pair& pair : kCalm) {
        for (const int n : {3, 5, 10, 20, 40}) {
            expect_95(coverage_of_ratio(20'000, n, pair.a, pair.b, kDelta), name_of(pair, n));
        }
    }
}

TEST(Coverage, OfTheBootstrapIs95PercentForSpreadsUpToOneHalf) {
    for (const Pair& pair : kCalm) {
        for (const int n : {5, 20}) {
            expect_95(coverage_of_ratio(2'500, n, pair.a, pair.b, kBootstrap), name_of(pair, n));
        }
    }
}

// The rows of the table in which it is said that intervals are too short.
TEST(Coverage, IsTooLowWhereTheHeaderSaysSo) {
    const auto delta = [](int n, const Errors& a) {
        return coverage_of_ratio(20'000, n, a, Errors{.spread = 0.2}, kDelta);
    };
    EXPECT_NEAR(delta(5, {.spread = 0.8}), 0.904, 0.01);
    EXPECT_NEAR(delta(20, {.spread = 0.8}), 0.922, 0.01);
    EXPECT_NEAR(delta(5, kSpiky), 0.674, 0.02);
    EXPECT_NEAR(delta(10, kSpiky), 0.871, 0.01);
    EXPECT_NEAR(delta(40, kSpiky), 0.940, 0.01);
}

TEST(Coverage, OfTheBootstrapOfPairsIs95PercentHoweverErrorsCorrelate) {
    for (const double rho : {-0.5, 0.5, 0.95}) {
        for (const int n : {5, 10}) {
            const double share = coverage(2'000, [&](std::mt19937_64& random) {
                std::normal_distribution<double> normal;
                Values a;
                Values b;
                for (int i = 0; i < n; ++i) {
                    const double z = normal(random);
                    a.push_back(std::exp(0.5 * z));
                    b.push_back(
                        std::exp(0.5 * (rho * z + std::sqrt(1 - rho * rho) * normal(random))));
                }
                return holds(bootstrap_paired_ratio(a, b), 1);
            });
            expect_95(share, std::to_string(rho) + " n = " + std::to_string(n));
        }
    }
}

TEST(Coverage, OverScenesIs95PercentWhereTheyAreNormalAndStated) {
    const auto share_of = [](int n, const auto& draw) {
        return coverage(2'000, [&](std::mt19937_64& random) {
            Values scenes;
            for (int i = 0; i < n; ++i) scenes.push_back(draw(random));
            return holds(geometric_mean_over_scenes(scenes), 1);
        });
    };
    const auto normal = [](std::mt19937_64& random) {
        return std::normal_distribution<double>(0, 0.4)(random);
    };
    const auto skewed = [](std::mt19937_64& random) {
        return 0.4 * (std::exponential_distribution<double>(1)(random) - 1);
    };
    for (const int n : {5, 8, 20}) expect_95(share_of(n, normal), std::to_string(n));
    EXPECT_NEAR(share_of(5, skewed), 0.929, 0.02);
    EXPECT_NEAR(share_of(20, skewed), 0.948, 0.02);
}

// What tail.h says of withheld intervals, and of those shown that miss the truth.
TEST(Tail, WithholdsIntervalsAsOftenAsItSays) {
    struct Row {
        Errors errors;
        int n;
        int n_kin;
        double withheld;
        double missing;
    };
    const std::vector<Row> table = {
        {{.spread = 0.5}, 5, 0, 0.02, 0.066},  {{.spread = 0.5}, 5, 2, 0.06, 0.064},
        {{.spread = 0.5}, 20, 2, 0.00, 0.058}, {{.spread = 0.8}, 5, 0, 0.17, 0.091},
        {{.spread = 0.8}, 20, 2, 0.22, 0.063}, {kSpiky, 5, 0, 0.38, 0.333},
        {kSpiky, 5, 2, 0.73, 0.100},           {kSpiky, 20, 2, 0.15, 0.023},
    };
    for (const Row& row : table) {
        constexpr int kTrials = 4'000;
        std::mt19937_64 random(7);
        const Errors calm{.spread = 0.2};
        int n_withheld = 0;
        int n_missing = 0;
        for (int trial = 0; trial < kTrials; ++trial) {
            const Values a = row.errors.draw(random, row.n);
            const Values b = calm.draw(random, row.n);
            std::vector<Values> kin;
            for (int k = 0; k < row.n_kin; ++k) kin.push_back(row.errors.draw(random, row.n));
            const bool is_withheld = judge_tail(a, kin) == TailVerdict::Dishonest;
            n_withheld += is_withheld ? 1 : 0;
            const bool is_held = holds(estimate_ratio(a, b), row.errors.mean() / calm.mean());
            n_missing += !is_withheld && !is_held ? 1 : 0;
        }
        EXPECT_NEAR(static_cast<double>(n_withheld) / kTrials, row.withheld, 0.03) << row.n;
        EXPECT_NEAR(static_cast<double>(n_missing) / kTrials, row.missing, 0.03) << row.n;
    }
}

TEST(Tail, IsJudgedByItsWeightAndByHowOftenItWasMet) {
    const Values calm = {1, 1.2, 0.9, 1.1, 1};
    const Values spike = {1, 1.2, 0.9, 1.1, 9};
    const Values two_spikes = {1, 1.2, 0.9, 8, 9};
    EXPECT_EQ(judge_tail(calm), TailVerdict::Calm);
    EXPECT_EQ(judge_tail(Values{1, 1.2, 0.9, 1.1, 3.5}), TailVerdict::Heavy);
    EXPECT_EQ(judge_tail(spike), TailVerdict::Dishonest);
    EXPECT_EQ(judge_tail(two_spikes), TailVerdict::Heavy);
    EXPECT_EQ(judge_tail(calm, std::vector<Values>{spike}), TailVerdict::Dishonest);
    EXPECT_EQ(judge_tail(two_spikes, std::vector<Values>{spike}), TailVerdict::Heavy);
    EXPECT_EQ(judge_tail(Values{1, 100}), TailVerdict::Calm);  // the median of two says nothing
    EXPECT_EQ(judge_tail(Values{-1, -1, 5}), TailVerdict::Calm);
}

TEST(Bootstrap, GivesTheSameIntervalForTheSameValuesAndNoneForTooFew) {
    const Values a = {1.0, 1.5, 1.25, 2.0, 1.75};
    const Values b = {3.0, 2.5, 3.5, 3.25, 2.75};
    EXPECT_EQ(bootstrap_ratio(a, b), bootstrap_ratio(a, b));
    EXPECT_LT(bootstrap_ratio(a, b)->interval->high, 1);
    const Values few = {1, 1.5, 1.25, 2};
    EXPECT_EQ(bootstrap_ratio(few, b)->why_none, NoInterval::TooFewToResample);
    EXPECT_EQ(bootstrap_paired_ratio(few, few)->why_none, NoInterval::TooFewToResample);
    EXPECT_EQ(bootstrap_paired_ratio(a, a)->why_none, NoInterval::NoSpread);
    EXPECT_EQ(bootstrap_ratio(a, Values{-1, -1, -1, -1, -1}), std::nullopt);
    EXPECT_EQ(geometric_mean_over_scenes(Values{}), std::nullopt);
    EXPECT_EQ(geometric_mean_over_scenes(few)->why_none, NoInterval::TooFewToResample);
    EXPECT_EQ(geometric_mean_over_scenes(Values(6, 0.1))->why_none, NoInterval::NoSpread);
    EXPECT_DOUBLE_EQ(geometric_mean_over_scenes(Values{std::log(2), std::log(8)})->value, 4);
}

// A table of 20 scenes and 5 methods against a baseline that the methods of a scene share, in which
// a fifth of the cells is truly better.
TEST(BenjaminiHochberg, HoldsTheRateOfFalseDiscoveriesOfATable) {
    constexpr int kTables = 300;
    constexpr double kLevel = 0.05;
    std::mt19937_64 random(11);
    const Errors errors{.spread = 0.3};
    double rate_adjusted = 0;
    double rate_raw = 0;
    double found = 0;
    for (int table = 0; table < kTables; ++table) {
        Values p;
        for (int scene = 0; scene < 20; ++scene) {
            const Values baseline = errors.draw(random, 10);
            for (int method = 0; method < 5; ++method) {
                Values values = errors.draw(random, 10);
                for (double& value : values) value *= method == 0 ? 0.55 : 1;
                p.push_back(p_value(log_ratio(values, baseline).value()));
            }
        }
        const Values adjusted = benjamini_hochberg(p);
        const auto false_rate = [&](const Values& of) {
            double n_found = 0;
            double n_false = 0;
            for (std::size_t i = 0; i < of.size(); ++i) {
                if (of[i] > kLevel) continue;
                n_found += 1;
                n_false += i % 5 == 0 ? 0 : 1;
            }
            return n_found > 0 ? n_false / n_found : 0;
        };
        rate_adjusted += false_rate(adjusted) / kTables;
        rate_raw += false_rate(p) / kTables;
        for (std::size_t i = 0; i < adjusted.size(); i += 5) {
            found += adjusted[i] <= kLevel ? 1.0 / (20 * kTables) : 0;
        }
    }
    EXPECT_LE(rate_adjusted, kLevel);
    EXPECT_GT(rate_raw, 2 * kLevel);  // what the adjustment is for
    EXPECT_GT(found, 0.8);
}

TEST(Power, IsTheShareOfExperimentsThatFindTheDifference) {
    for (const int n : {5, 20}) {
        const double share = coverage(10'000, [n](std::mt19937_64& random) {
            const Values a = Errors{.spread = 0.1}.draw(random, n);
            Values b = Errors{.spread = 0.1}.draw(random, n);
            for (double& value : b) value *= 1.1;
            return excludes_one(estimate_ratio(a, b).value());
        });
        EXPECT_NEAR(power_of_ratio(1.1, 0.1, n), share, 0.02) << n;
    }
    const int needed = seeds_for_power(1.05, 0.1, 1000).value();
    EXPECT_GE(power_of_ratio(1.05, 0.1, needed), 0.8);
    EXPECT_LT(power_of_ratio(1.05, 0.1, needed - 1), 0.8);
    EXPECT_EQ(seeds_for_power(1.05, 0.1, needed - 1), std::nullopt);
    EXPECT_EQ(power_of_ratio(1.05, 0, 3), 1);
}

TEST(Power, SharesHaveClopperAndPearsonsInterval) {
    // A table's: 2 of 20.
    EXPECT_NEAR(share_interval(2, 20).low, 0.0123, 1e-4);
    EXPECT_NEAR(share_interval(2, 20).high, 0.3170, 1e-4);
    EXPECT_EQ(share_interval(0, 20).low, 0);
    EXPECT_EQ(share_interval(20, 20).high, 1);
}

}  // namespace
}  // namespace misbench
