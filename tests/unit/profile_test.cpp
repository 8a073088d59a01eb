// Profiles and claims as they are read from an experiment file, and what is said of wrong ones.
#include "experiments/plan/profile.h"

#include <gmock/gmock.h>

#include "experiments/plan/experiment_file.h"
#include "renderer/base/files.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kExperiment = R"(name: exp
scenes: [A, B]
methods:
  pt: {method: path, max_depth: 5, mis: balance}
  direct: {method: direct}
seeds: 4
budgets: [{seconds: 30}]
image: {width: 640, height: 480}
reference: {method: pt, samples: 1024}
profiles:
  laptop:
    image: {width: 160}
    seeds: [7, 8]
    budgets: [{seconds: 3}]
    reference: {samples: 64}
    methods: {pt: {max_depth: 3}, extra: {method: path}}
    scenes: [C]
    description: small
  paper: {}
claims:
  - claim: better
    method: pt
    expect: less
)";

class ProfileTest : public testing::Test {
 protected:
    ExperimentYaml read(const std::string& text, const std::string& profile = "",
                        const std::vector<std::string>& overrides = {}) const {
        write_file_durably(file_, text);
        return read_experiment_yaml(file_, overrides, profile);
    }

    // Without the name of the file.
    std::string complaint(const std::string& text, const std::string& profile = "") const {
        const std::string message = message_of(Errc::InvalidArgument, [&] { read(text, profile); });
        const std::string prefix = file_.string() + ":";
        return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
    }

    static std::string changed(const std::string& from, const std::string& to) {
        std::string text = kExperiment;
        const auto at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    }

    TemporaryFolder temporary_;
    const std::filesystem::path file_ = temporary_.path() / "exp.yaml";
};

TEST_F(ProfileTest, TheFirstIsTheDefaultAndKeepsTheNameOfTheExperiment) {
    const ExperimentYaml e = read(kExperiment);
    EXPECT_EQ(e.profile.name, "laptop");
    EXPECT_THAT(e.profile.known, ElementsAre("laptop", "paper"));
    EXPECT_EQ(e.name, "exp");
    EXPECT_EQ(read(kExperiment, "laptop").name, "exp");
    EXPECT_EQ(read(kExperiment, "paper").name, "exp-paper");
}

TEST_F(ProfileTest, MapsAreMergedKeyByKeyAndAllElseIsReplaced) {
    const ExperimentYaml e = read(kExperiment, "laptop");
    EXPECT_EQ(e.description, "small");
    ASSERT_EQ(e.scenes.size(), 1U);
    EXPECT_EQ(e.scenes[0].scene.value, "C");
    EXPECT_EQ(e.scenes[0].image.width, 160);
    EXPECT_EQ(e.scenes[0].image.height, 480);
    ASSERT_EQ(e.methods.size(), 3U);
    EXPECT_EQ(to_map(e.methods[0].parameters),
              (ParameterMap{{"max_depth", std::int64_t{3}}, {"mis", std::string("balance")}}));
    EXPECT_EQ(e.methods[2].label.value, "extra");
    ASSERT_EQ(e.seeds.size(), 2U);
    EXPECT_EQ(e.seeds[0].value, 7);
    ASSERT_EQ(e.budgets.size(), 1U);
    EXPECT_EQ(e.budgets[0].value, Budget(TimeBudget{3, BudgetClock::Cpu}));
    EXPECT_EQ(e.reference.method.value, "pt");
    EXPECT_EQ(e.reference.samples, 64);
}

TEST_F(ProfileTest, AProfileThatSaysNothingIsTheFileAsItIs) {
    const ExperimentYaml e = read(kExperiment, "paper");
    EXPECT_EQ(e.scenes.size(), 2U);
    EXPECT_EQ(e.scenes[0].image.width, 640);
    EXPECT_EQ(e.methods.size(), 2U);
    EXPECT_EQ(e.seeds.size(), 4U);
    EXPECT_EQ(e.reference.samples, 1024);
}

TEST_F(ProfileTest, ASeedRuleIsMergedIntoARuleAndReplacesAllElse) {
    const std::string rule = "seeds: {min: 5, max: 40, until: {ratio_halfwidth: 0.1}}";
    const ExperimentYaml given = read(changed("seeds: 4", rule), "paper");
    EXPECT_EQ(given.seed_rule, (SeedRule{.min = 5, .max = 40, .ratio_halfwidth = 0.1}));
    EXPECT_EQ(given.seeds.size(), 40U);
    EXPECT_EQ(read(changed("seeds: 4", rule), "laptop").seed_rule, std::nullopt);
    EXPECT_EQ(read(changed("seeds: [7, 8]", rule)).seed_rule, given.seed_rule);
    const std::string text = changed("seeds: 4", rule);
    const std::string merged = std::string(text).replace(text.find("[7, 8]"), 6,
                                                         "{max: 9, until: {ratio_halfwidth: 0.5}}");
    EXPECT_EQ(read(merged).seed_rule, (SeedRule{.min = 5, .max = 9, .ratio_halfwidth = 0.5}));
    EXPECT_EQ(read(merged, "", {"seeds.min=7"}).seed_rule->min, 7);
}

TEST_F(ProfileTest, SetComesAfterTheProfile) {
    const ExperimentYaml e =
        read(kExperiment, "laptop", {"image.width=99", "methods.extra.max_depth=2", "name=other"});
    EXPECT_EQ(e.scenes[0].image.width, 99);
    EXPECT_EQ(to_map(e.methods[2].parameters), (ParameterMap{{"max_depth", std::int64_t{2}}}));
    EXPECT_EQ(e.name, "other");
}

TEST_F(ProfileTest, WhatIsWrongIsSaidWhereItIsWritten) {
    EXPECT_EQ(complaint(kExperiment, "papr"),
              "--profile papr: unknown profile 'papr' (did you mean 'paper'?); known: laptop "
              "paper");
    EXPECT_EQ(complaint(changed("image: {width: 160}", "image: {width: wide}")),
              "12:20: width must be a decimal integer from 1 to 16384: found 'wide'");
    EXPECT_THAT(complaint(changed("seeds: [7, 8]", "sedes: 3")),
                StartsWith("13:5: unknown key 'sedes' (did you mean 'seeds'?)"));
    EXPECT_EQ(complaint(changed("extra: {method: path}", "extra: {max_depth: 2}")),
              "16:42: method 'extra' lacks 'method'");
    EXPECT_EQ(complaint(changed("description: small", "name: small")),
              "18:5: a profile cannot override 'name'");
    EXPECT_EQ(complaint(changed("paper: {}", "paper: {profiles: {}}")),
              "19:11: a profile cannot override 'profiles'");
    EXPECT_EQ(complaint(changed("paper: {}", "paper: 3")),
              "19:10: profile 'paper' must be a map: found '3'");
    EXPECT_THAT(complaint(changed("paper: {}", "\"a b\": {}")),
                StartsWith("19:3: the name of a profile must be 1 to 100 letters"));
    EXPECT_EQ(complaint("name: x\nprofiles: {}\n"), "2:11: profiles must not be empty");
    EXPECT_EQ(complaint("name: x\nprofiles: [a]\n"), "2:11: profiles must be a map: found a list");
    EXPECT_EQ(complaint("name: x\n", "laptop"),
              "--profile laptop: the experiment file has no profiles");
    EXPECT_THAT(complaint(changed("name: exp", "name: [exp]"), "paper"),
                StartsWith("1:7: name must be text: found a list"));
}

TEST_F(ProfileTest, AFileForTheLabIsNamedAsSuch) {
    EXPECT_EQ(complaint("name: x\nproblems: [a]\n"),
              "2:1: a file for `misbench lab`, not an experiment");
    EXPECT_TRUE(is_lab_file(file_));
    read(kExperiment);
    EXPECT_FALSE(is_lab_file(file_));
}

// --- claims --------------------------------------------------------------------------------------

constexpr const char* kClaim = "claim: better\n    method: pt\n    expect: less\n";

TEST_F(ProfileTest, EveryKeyOfAClaimIsRead) {
    const ExperimentYaml e = read(changed(
        kClaim,
        "{claim: c, where: Fig. 8, scenes: [A, B], method: pt, against: direct, metric: mse,\n"
        "    budget: {samples: 4}, over: each, expect: not_less, margin: 0.1,\n"
        "    paper: {A: 0.5, B: 2}, note: n}\n"));
    ASSERT_EQ(e.claims.size(), 1U);
    const ClaimEntry& claim = e.claims[0];
    EXPECT_EQ(claim.text, "c");
    EXPECT_EQ(claim.where, "Fig. 8");
    ASSERT_EQ(claim.scenes.size(), 2U);
    EXPECT_EQ(claim.scenes[1].value, "B");
    EXPECT_EQ(claim.method.value, "pt");
    EXPECT_EQ(claim.against->value, "direct");
    EXPECT_EQ(claim.metric->value, "mse");
    EXPECT_EQ(claim.budget->value, Budget(SampleBudget{4}));
    EXPECT_EQ(claim.over, ClaimOver::Each);
    EXPECT_EQ(claim.expect, Expectation::NotLess);
    EXPECT_EQ(claim.margin, 0.1);
    ASSERT_EQ(claim.paper.size(), 2U);
    EXPECT_EQ(claim.paper[1].scene.value, "B");
    EXPECT_EQ(claim.paper[1].ratio, 2);
    EXPECT_EQ(claim.note, "n");
}

TEST_F(ProfileTest, WhatAClaimLeavesOutHasItsDefault) {
    const ExperimentYaml e = read(kExperiment);
    ASSERT_EQ(e.claims.size(), 1U);
    EXPECT_FALSE(e.claims[0].against || e.claims[0].metric || e.claims[0].budget);
    EXPECT_EQ(e.claims[0].over, ClaimOver::Each);
    EXPECT_EQ(e.claims[0].margin, 0.05);
    EXPECT_TRUE(e.claims[0].scenes.empty() && e.claims[0].paper.empty());
}

TEST_F(ProfileTest, AWrongClaimIsSaidWithItsPlace) {
    const auto with = [this](const std::string& more) {
        return complaint(changed(kClaim, "{claim: c, method: pt, " + more + "}\n"));
    };
    EXPECT_EQ(with("expect: les"),
              "21:36: unknown expectation 'les'; known: less more not_more "
              "not_less equal");
    EXPECT_EQ(with("expect: less, over: all"),
              "21:48: unknown value of 'over' 'all'; known: each mean worst best");
    EXPECT_EQ(with("expect: less, margin: 0"),
              "21:50: margin must be above 0 and at most 1: found 0");
    EXPECT_EQ(with("expect: less, margin: 1.5"),
              "21:50: margin must be above 0 and at most 1: found 1.5");
    EXPECT_EQ(with("expect: less, paper: -1"),
              "21:49: the paper's ratio must be above 0: found -1");
    EXPECT_EQ(with("expect: less, over: mean, paper: {A: 1}"),
              "21:61: a claim over 'mean' has one number; known: numbers by scene only over "
              "'each'");
    EXPECT_EQ(with("where: x"), "21:5: a claim lacks 'expect'");
    EXPECT_THAT(with("expect: less, wher: x"),
                AllOf(StartsWith("21:42: unknown key 'wher' (did you mean 'where'?)"),
                      HasSubstr("known: claim where scenes method")));
    EXPECT_EQ(complaint(changed(std::string("- ") + kClaim, "[]\n")),
              "21:3: claims must not be empty");
}

}  // namespace
}  // namespace misbench
