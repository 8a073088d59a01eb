// Which seeds an experiment with a seed rule renders next, from made-up tables: no store, no
// renderer. Where the seeds go within a round is the matter of tests/stat/allocation_test.cpp.
#include "experiments/analysis/seed_rounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "experiments/plan/imported.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Budget kBudget = SampleBudget{16};
constexpr SeedRule kRule{.min = 5, .max = 40, .ratio_halfwidth = 0.1};

// Two scenes with a baseline, a method whose ratio is known at once and one whose ratio is not.
Plan largest_plan(const SeedRule& rule = kRule) {
    Plan plan = made_up_plan("first", 0);
    plan.scenes = {{.name = "Box", .exposure = 0}, {.name = "Hall", .exposure = 0}};
    plan.methods = {"plain", "easy", "hard"};
    plan.seed_rule = rule;
    for (std::int64_t seed = 1; seed <= rule.max; ++seed) {
        for (const PlannedScene& scene : plan.scenes) {
            for (const std::string& method : plan.methods) {
                plan.cells.push_back({.scene = scene.name,
                                      .method = method,
                                      .budget = kBudget,
                                      .seed = seed,
                                      .role = Role::Test,
                                      .task = made_up_task(method, seed, kBudget)});
            }
        }
    }
    return plan;
}

struct Errors {
    double spread = 0;  // of the logarithm
    double scale = 1;
    double seconds = 1;  // of a seed
};
using ErrorsOf = std::function<Errors(const std::string& scene, const std::string& method)>;

Errors usual_errors(const std::string& /*scene*/, const std::string& method) {
    return {.spread = method == "hard" ? 0.4 : 0.01};
}

// The table of a plan whose tests are all done.
Comparison comparison_of(const Plan& plan, const ErrorsOf& errors_of = usual_errors) {
    Comparison comparison{.experiment = plan.experiment,
                          .metric = "relmse.eps0.01",
                          .formula = "",
                          .baseline = plan.baseline,
                          .scenes = {},
                          .methods = plan.methods,
                          .budgets = plan.budgets,
                          .cells = {}};
    comparison.seed_rule = {*plan.seed_rule, "relmse.eps0.01", plan.baseline, true};
    for (const PlannedScene& scene : plan.scenes) {
        comparison.scenes.push_back(scene.name);
        for (const std::string& method : plan.methods) {
            const Errors errors = errors_of(scene.name, method);
            ComparedCell cell;
            cell.scene = scene.name;
            cell.method = method;
            cell.budget = kBudget;
            cell.is_baseline = method == plan.baseline;
            cell.mean_cpu_seconds = errors.seconds;
            for (const Cell& planned : plan.cells) {
                const bool is_here = planned.role == Role::Test && planned.scene == scene.name &&
                                     planned.method == method;
                if (!is_here) continue;
                std::mt19937_64 random(
                    static_cast<unsigned>(7919 * planned.seed) +
                    static_cast<unsigned>(131 * scene.name.front() + method.front()));
                std::lognormal_distribution<double> error(0, errors.spread);
                cell.seeds.push_back(planned.seed);
                cell.values.push_back(errors.scale * error(random));
            }
            cell.n_planned = cell.n_measured = static_cast<int>(cell.seeds.size());
            if (cell.n_planned > 0) comparison.cells.push_back(std::move(cell));
        }
    }
    return comparison;
}

ComparedCell& cell_of(Comparison& comparison, const std::string& scene, const std::string& method) {
    for (ComparedCell& cell : comparison.cells) {
        if (cell.scene == scene && cell.method == method) return cell;
    }
    throw std::out_of_range(scene + " " + method);
}

// How the last seed of a cell ended; its value is gone.
void lose_a_seed(ComparedCell& cell, int ComparedCell::*count) {
    ++(cell.*count);
    --cell.n_measured;
    cell.values.pop_back();
    cell.seeds.pop_back();
}

std::vector<std::int64_t> seeds_of(const Plan& plan, const std::string& scene,
                                   const std::string& method) {
    std::vector<std::int64_t> seeds;
    for (const Cell& cell : plan.cells) {
        const bool is_here = cell.role == Role::Test && cell.scene == scene;
        if (is_here && cell.method == method) seeds.push_back(cell.seed);
    }
    return seeds;
}

std::vector<std::size_t> counts_of(const Plan& plan, const std::string& scene) {
    std::vector<std::size_t> counts;
    for (const std::string& method : plan.methods) {
        counts.push_back(seeds_of(plan, scene, method).size());
    }
    return counts;
}

// Round after round, to the end.
std::vector<Plan> all_rounds(const Plan& largest, const ErrorsOf& errors_of = usual_errors) {
    std::vector<Plan> rounds{first_round(largest)};
    while (const auto next = next_round(largest, comparison_of(rounds.back(), errors_of))) {
        rounds.push_back(*next);
        if (rounds.size() > 1000) throw std::runtime_error("the rounds have no end");
    }
    return rounds;
}

TEST(SeedRounds, TheFirstHasTheReferencesAndTheFewestSeedsOfEachCell) {
    const Plan largest = largest_plan();
    const Plan first = first_round(largest);
    EXPECT_EQ(first.cells.size(), 2U + 2 * 3 * 5);
    EXPECT_EQ(first.cells[0].role, Role::ReferenceA);
    EXPECT_EQ(first.cells[1].role, Role::ReferenceB);
    EXPECT_THAT(seeds_of(first, "Hall", "hard"), ElementsAre(1, 2, 3, 4, 5));
    EXPECT_EQ(first.seed_rule, largest.seed_rule);
    Plan fixed = largest;
    fixed.seed_rule.reset();
    EXPECT_EQ(first_round(fixed), fixed);
}

TEST(SeedRounds, TheNextSeedsAreOfWideRatiosAndTheirBaselines) {
    const Plan largest = largest_plan();
    // In Hall every ratio is narrow.
    const auto errors_of = [](const std::string& scene, const std::string& method) {
        return scene == "Hall" ? Errors{.spread = 0.01} : usual_errors(scene, method);
    };
    const Plan first = first_round(largest);
    const Plan next = next_round(largest, comparison_of(first, errors_of)).value();
    EXPECT_THAT(counts_of(next, "Hall"), ElementsAre(5, 5, 5));
    EXPECT_EQ(seeds_of(next, "Box", "easy").size(), 5U);
    const auto hard = seeds_of(next, "Box", "hard");
    EXPECT_GT(hard.size(), 5U);
    EXPECT_LE(hard.size(), 10U);
    EXPECT_EQ(hard.back(), static_cast<std::int64_t>(hard.size()));
    EXPECT_EQ(seeds_of(next, "Box", "plain"), hard);
}

TEST(SeedRounds, RoundsOnlyGrowAndEndWhereEveryRatioIsNarrow) {
    const Plan largest = largest_plan({.min = 5, .max = 1000, .ratio_halfwidth = 0.1});
    const std::vector<Plan> rounds = all_rounds(largest);
    EXPECT_GT(rounds.size(), 3U);
    for (std::size_t i = 1; i < rounds.size(); ++i) {
        EXPECT_GT(rounds[i].cells.size(), rounds[i - 1].cells.size());
        for (const std::string scene : {"Box", "Hall"}) {
            const auto before = counts_of(rounds[i - 1], scene);
            const auto now = counts_of(rounds[i], scene);
            for (std::size_t m = 0; m < now.size(); ++m) EXPECT_GE(now[m], before[m]);
        }
    }
    const Comparison last = comparison_of(rounds.back());
    const RuleOutcome outcome = outcome_of_rule(last);
    EXPECT_EQ(outcome.n_narrow, 4U);
    EXPECT_EQ(outcome.n_ratios(), 4U);
    // v of a pair is 0.16, narrow at 1.98 √(v/n) = log 1.1: 69 pairs.
    EXPECT_GT(counts_of(rounds.back(), "Box")[2], 35U);
    EXPECT_LT(counts_of(rounds.back(), "Box")[2], 140U);
    EXPECT_THAT(counts_of(rounds.back(), "Box")[1], 5U);
}

TEST(SeedRounds, AHopelessRatioEndsWithTheMostSeeds) {
    const Plan largest = largest_plan();
    const auto errors_of = [](const std::string&, const std::string& method) {
        return Errors{.spread = method == "hard" ? 2.0 : 0.01};
    };
    const Plan last = all_rounds(largest, errors_of).back();
    for (const std::string scene : {"Box", "Hall"}) {
        EXPECT_THAT(counts_of(last, scene), ElementsAre(40, 5, 40));
    }
    const Comparison comparison = comparison_of(last, errors_of);
    EXPECT_EQ(outcome_of_rule(comparison).n_at_most, 2U);
    EXPECT_EQ(seed_rule_footnote(comparison),
              "seeds: 5 to 40, until the ratio is known within ± 10 %: met by 2 of 4 ratios; 2 "
              "stopped at 40 seeds");
}

TEST(SeedRounds, FollowFromThePlanAndTheRunsAlone) {
    const std::vector<Plan> rounds = all_rounds(largest_plan());
    EXPECT_EQ(all_rounds(largest_plan()), rounds);
    // Neither does it matter which method is better, nor whether anything is significant.
    const auto scaled = [](double scale) {
        return [scale](const std::string& scene, const std::string& method) {
            Errors errors = usual_errors(scene, method);
            if (method != "plain") errors.scale = scale;
            return errors;
        };
    };
    EXPECT_EQ(all_rounds(largest_plan(), scaled(0.0625)), rounds);
    EXPECT_EQ(all_rounds(largest_plan(), scaled(1024)), rounds);
}

// Both methods are equally wide and take equal time; one has the baseline's seeds already.
TEST(SeedRounds, TheSeedsOfTheBaselineAreThereForEveryRatio) {
    Plan largest = largest_plan({.min = 5, .max = 100, .ratio_halfwidth = 0.01});
    largest.scenes.pop_back();
    Plan now = first_round(largest);
    const auto add = [&](const std::string& method, std::int64_t n) {
        for (const Cell& cell : largest.cells) {
            const bool is_wanted = cell.role == Role::Test && cell.scene == "Box" &&
                                   cell.method == method && cell.seed > 5 && cell.seed <= n;
            if (is_wanted) now.cells.push_back(cell);
        }
    };
    add("plain", 40);
    add("hard", 40);
    // A seed of "easy" takes 1 s with the baseline's there, 101 s without.
    const auto errors_of = [](const std::string&, const std::string& method) {
        return Errors{.spread = method == "plain" ? 0.01 : 0.4,
                      .seconds = method == "plain" ? 100.0 : 1.0};
    };
    const Plan next = next_round(largest, comparison_of(now, errors_of)).value();
    EXPECT_EQ(seeds_of(next, "Box", "easy").size(), 10U) << "it may double";
    const auto counts = counts_of(next, "Box");
    EXPECT_EQ(counts[0], counts[2]);
    EXPECT_LT(counts[2], 80U) << "half of the time so far, of 4045 s";
}

TEST(SeedRounds, WhereRunsAreUnfinishedNothingIsNext) {
    const Plan largest = largest_plan();
    Comparison comparison = comparison_of(first_round(largest));
    lose_a_seed(cell_of(comparison, "Hall", "easy"), &ComparedCell::n_unfinished);
    EXPECT_EQ(next_round(largest, comparison), std::nullopt);
    EXPECT_THAT(seed_rule_footnote(comparison),
                HasSubstr(": met by 2 of 4 ratios; 2 wide with fewer seeds"));
}

TEST(SeedRounds, ARatioWithFailedOrInvalidRunsIsLeftAsItIs) {
    const Plan largest = largest_plan();
    for (const auto count :
         {&ComparedCell::n_failed, &ComparedCell::n_invalid, &ComparedCell::n_unreferenced}) {
        Comparison comparison = comparison_of(first_round(largest));
        lose_a_seed(cell_of(comparison, "Box", "hard"), count);
        const Plan next = next_round(largest, comparison).value();
        EXPECT_THAT(counts_of(next, "Box"), ElementsAre(5, 5, 5));
        EXPECT_GT(seeds_of(next, "Hall", "hard").size(), 5U);
        EXPECT_EQ(outcome_of_rule(comparison).n_incomplete, 1U);
        EXPECT_THAT(seed_rule_footnote(comparison),
                    HasSubstr("; 1 left with failed or invalid runs, 1 wide with fewer seeds"));

        comparison = comparison_of(first_round(largest));
        for (const std::string scene : {"Box", "Hall"}) {
            lose_a_seed(cell_of(comparison, scene, "plain"), count);
        }
        EXPECT_EQ(next_round(largest, comparison), std::nullopt) << "of a baseline";
    }
}

TEST(SeedRounds, WhatTheFileExcludesTakesNothingFromTheOthers) {
    Plan largest = largest_plan();
    std::erase_if(largest.cells, [](const Cell& cell) {
        if (cell.role != Role::Test) return false;
        // "hard" has its fewest seeds in Box, and Hall no baseline for a few.
        return (cell.scene == "Box" && cell.method == "hard" && cell.seed > 5) ||
               (cell.scene == "Hall" && cell.method == "plain" && cell.seed < 3);
    });
    const auto errors_of = [](const std::string& scene, const std::string& method) {
        return Errors{.spread = method != "hard" ? 0.01 : scene == "Box" ? 50.0 : 0.4};
    };
    const Plan last = all_rounds(largest, errors_of).back();
    EXPECT_THAT(counts_of(last, "Box"), ElementsAre(5, 5, 5));
    EXPECT_EQ(seeds_of(last, "Hall", "hard").size(), 40U);

    // Without a baseline there is no ratio.
    std::erase_if(largest.cells, [](const Cell& cell) {
        return cell.role == Role::Test && cell.method == "plain";
    });
    const Comparison comparison = comparison_of(first_round(largest), errors_of);
    EXPECT_EQ(next_round(largest, comparison), std::nullopt);
    EXPECT_EQ(outcome_of_rule(comparison).n_ratios(), 0U);
}

TEST(SeedRounds, ImportedImagesHaveNoFurtherSeeds) {
    const Plan largest = largest_plan();
    const auto narrow = [](const std::string&, const std::string&) { return Errors{0.01}; };
    Comparison comparison = comparison_of(first_round(largest), narrow);
    ComparedCell imported = cell_of(comparison, "Box", "easy");
    imported.method = "theirs";
    imported.parameters[kImportParameter] = std::string("a hash");
    for (std::size_t i = 0; i < imported.values.size(); ++i) {
        imported.values[i] *= 1.0 + static_cast<double>(i);
    }
    comparison.cells.push_back(imported);
    EXPECT_EQ(next_round(largest, comparison), std::nullopt);
    EXPECT_EQ(outcome_of_rule(comparison).n_ratios(), 4U);
}

TEST(SeedRounds, TheFootnoteSaysWhatIsKnownOfOtherTables) {
    Comparison comparison = comparison_of(first_round(largest_plan()));
    comparison.metric = "mse";
    comparison.seed_rule->is_of_these = false;
    EXPECT_EQ(seed_rule_footnote(comparison),
              "seeds: 5 to 40, until the ratio to 'plain' in relmse.eps0.01 is known within ± 10 "
              "%");
    comparison.seed_rule.reset();
    EXPECT_THAT(seed_rule_footnote(comparison), IsEmpty());
}

TEST(SeedRounds, ThePlanKeepsItsRuleAndCellsOfDifferentNumbers) {
    const Plan last = all_rounds(largest_plan()).back();
    const nlohmann::json json = plan_to_json(last);
    EXPECT_EQ(json.at("seed_rule"), nlohmann::json::parse(R"({"min": 5, "max": 40,
              "until": {"ratio_halfwidth": 0.1}})"));
    EXPECT_EQ(plan_from_json(json), last);
    Plan fixed = last;
    fixed.seed_rule.reset();
    EXPECT_FALSE(plan_to_json(fixed).contains("seed_rule"));
    EXPECT_EQ(plan_from_json(plan_to_json(fixed)), fixed);
}

// --- pairs of cells with different numbers of seeds ----------------------------------------------

TEST(PairsOfCells, AreOfTheSeedsThatBothHave) {
    ComparedCell few;
    few.seeds = {3, 1, 2};
    few.values = {6.5, 2.25, 4};
    ComparedCell many;
    many.seeds = {1, 2, 3, 4};
    many.values = {1, 2, 3, 1000};
    EXPECT_TRUE(are_paired(few, many));
    const LogRatio found = log_ratio(few, many).value();
    const LogRatio expected =
        paired_log_ratio(std::vector{6.5, 2.25, 4.0}, std::vector{3.0, 1.0, 2.0}).value();
    EXPECT_DOUBLE_EQ(found.value, expected.value);
    EXPECT_DOUBLE_EQ(found.variance, expected.variance);
    EXPECT_EQ(found.degrees_of_freedom, 2);
    const LogRatio inverse = log_ratio(many, few).value();
    EXPECT_DOUBLE_EQ(inverse.value, -found.value);
    EXPECT_DOUBLE_EQ(inverse.variance, found.variance);

    few.seeds = {3, 1, 5};
    EXPECT_FALSE(are_paired(few, many)) << "a seed of the smaller one has no partner";
    EXPECT_EQ(log_ratio(few, many)->value, log_ratio(few.values, many.values)->value);
}

}  // namespace
}  // namespace misbench
