// The experiment file: what is read, and that everything wrong is said with its place.
#include "experiments/plan/experiment_file.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "experiments/plan/suggestion.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kComplete = R"(name: first-light
description: Which estimator?
scenes:
  - CornellBox
  - scene: VeachMIS
    image: {width: 320}
    exposure: -1.5
    parameters: {max_depth: 3}
methods:
  bsdf: {method: path, nee: false, mis: "power2"}
  pt:
    method: path
    max_depth: 5
    clamp: 1e3
seeds: [3, 1, 2]
budgets:
  - samples: 16
  - {seconds: 0.5, clock: wall}
  - {seconds: 2}
image: {width: 64, height: 48}
reference: {method: pt, samples: 1024, seeds: [70, 71], max_depth: 6}
include:
  - {scene: [CornellBox, VeachMIS]}
exclude:
  - scene: VeachMIS
    method: bsdf
    seed: [1, 2]
    budget: {samples: 16}
baseline: pt
metrics: [mse, mean]
)";

class ExperimentFileTest : public testing::Test {
 protected:
    void SetUp() override {
        file_ =
            std::filesystem::path(testing::TempDir()) /
            (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".yaml");
    }
    void TearDown() override { std::filesystem::remove(file_); }

    ExperimentYaml read(const std::string& text, const std::vector<std::string>& overrides = {}) {
        std::ofstream(file_) << text;
        return read_experiment_yaml(file_, overrides);
    }

    // The message of what is wrong, without the name of the file.
    std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
        try {
            read(text, overrides);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), Errc::InvalidArgument);
            const std::string message = e.what();
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            const std::string prefix = file_.string() + ":";
            return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
        }
        return "no complaint";
    }

    std::filesystem::path file_;
};

// kComplete with one piece of text replaced.
std::string changed(const std::string& from, const std::string& to) {
    std::string text = kComplete;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST_F(ExperimentFileTest, EveryKeyIsRead) {
    const ExperimentYaml e = read(kComplete);
    EXPECT_EQ(e.name, "first-light");
    EXPECT_EQ(e.description, "Which estimator?");
    ASSERT_EQ(e.scenes.size(), 2U);
    EXPECT_EQ(e.scenes[0].scene.value, "CornellBox");
    EXPECT_EQ(e.scenes[0].image.width, 64);
    EXPECT_EQ(e.scenes[1].image.width, 320);
    EXPECT_EQ(e.scenes[1].image.height, 48);
    EXPECT_EQ(e.scenes[1].exposure, -1.5);
    EXPECT_EQ(to_map(e.scenes[1].parameters), (ParameterMap{{"max_depth", std::int64_t{3}}}));
    ASSERT_EQ(e.methods.size(), 2U);
    EXPECT_EQ(e.methods[0].label.value, "bsdf");
    EXPECT_EQ(to_map(e.methods[0].parameters),
              (ParameterMap{{"nee", false}, {"mis", std::string("power2")}}));
    EXPECT_EQ(to_map(e.methods[1].parameters),
              (ParameterMap{{"max_depth", std::int64_t{5}}, {"clamp", 1000.0}}));
    EXPECT_EQ(e.seeds.size(), 3U);
    EXPECT_EQ(e.seeds[0].value, 3);
    ASSERT_EQ(e.budgets.size(), 3U);
    EXPECT_EQ(e.budgets[0].value, Budget(SampleBudget{16}));
    EXPECT_EQ(e.budgets[1].value, Budget(TimeBudget{0.5, BudgetClock::Wall}));
    EXPECT_EQ(e.budgets[2].value, Budget(TimeBudget{2, BudgetClock::Cpu}));
    EXPECT_EQ(e.reference.method.value, "pt");
    EXPECT_EQ(e.reference.samples, 1024);
    EXPECT_EQ(e.reference.seed_b.value, 71);
    EXPECT_EQ(to_map(e.reference.parameters), (ParameterMap{{"max_depth", std::int64_t{6}}}));
    EXPECT_EQ(e.include.at(0).scenes.size(), 2U);
    EXPECT_EQ(e.exclude.at(0).budgets.at(0).value, Budget(SampleBudget{16}));
    EXPECT_EQ(e.exclude.at(0).seeds.size(), 2U);
    EXPECT_EQ(e.baseline->value, "pt");
    EXPECT_EQ(e.metrics.size(), 2U);
}

TEST_F(ExperimentFileTest, WhatIsLeftOutHasItsDefault) {
    const ExperimentYaml e = read(
        "name: x\nscenes: [A]\nmethods: {pt: {method: path}}\nseeds: 3\n"
        "budgets: [{samples: 1}]\nreference: {method: pt, samples: 9}\n");
    EXPECT_EQ(e.scenes[0].image.width, 640);
    EXPECT_EQ(e.scenes[0].image.height, 480);
    EXPECT_EQ(e.seeds.size(), 3U);
    EXPECT_EQ(e.seeds[0].value, 1);
    EXPECT_EQ(e.seeds[2].value, 3);
    EXPECT_EQ(e.reference.seed_a.value, 1000001);
    EXPECT_EQ(e.reference.seed_b.value, 1000002);
    EXPECT_EQ(e.metrics.at(0).value, "relmse.eps0.01");
    EXPECT_FALSE(e.baseline.has_value());
    EXPECT_FALSE(e.snapshots.has_value());
}

TEST_F(ExperimentFileTest, SnapshotsHaveAFactorAndMayHaveAFirst) {
    const auto snapshots = [this](const std::string& value) {
        return read(kComplete + ("snapshots: " + value + "\n")).snapshots;
    };
    EXPECT_EQ(snapshots("2"), (SnapshotLadder{.first = 1, .factor = 2}));
    EXPECT_EQ(snapshots("{factor: 4, first: 16}"), (SnapshotLadder{.first = 16, .factor = 4}));
}

struct Fault {
    const char* from;
    const char* to;
    const char* complaint;
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.to; }

class ExperimentFileFault : public ExperimentFileTest, public testing::WithParamInterface<Fault> {
    void SetUp() override {
        file_ =
            std::filesystem::path(testing::TempDir()) /
            ("fault" + std::to_string(reinterpret_cast<std::uintptr_t>(GetParam().to)) + ".yaml");
    }
};

TEST_P(ExperimentFileFault, IsSaidWithItsPlace) {
    EXPECT_THAT(complaint(changed(GetParam().from, GetParam().to)),
                StartsWith(GetParam().complaint));
}

constexpr const char* kTopKeys =
    "known: name description scenes methods seeds budgets image reference include exclude "
    "baseline metrics profiles claims snapshots";

INSTANTIATE_TEST_SUITE_P(
    All, ExperimentFileFault,
    testing::Values(
        // Keys.
        Fault{"seeds: [", "sedes: [", "15:1: unknown key 'sedes' (did you mean 'seeds'?); known: "},
        Fault{"metrics: [mse, mean]", "zebra: 1", "30:1: unknown key 'zebra'; known: name desc"},
        Fault{"{width: 320}", "{widht: 320}",
              "6:13: unknown key 'widht' (did you mean 'width'?); known: width height"},
        Fault{"    exposure", "    exposre",
              "7:5: unknown key 'exposre' (did you mean 'exposure'?); known: scene image"},
        Fault{"- samples: 16", "- sample: 16",
              "17:5: unknown key 'sample' (did you mean 'samples'?); known: samples seconds clock"},
        Fault{"    method: bsdf", "    mehtod: bsdf", "26:5: unknown key 'mehtod'"},
        Fault{"clamp: 1e3", "max_depth: 3",
              "14:5: key 'max_depth' is written twice, first at line 13"},
        Fault{"baseline: pt", "name: twice", "29:1: key 'name' is written twice, first at line 1"},
        Fault{"name: first-light\n", "", "1:1: the experiment file lacks 'name'"},
        Fault{"seeds: [3, 1, 2]\n", "", "1:1: the experiment file lacks 'seeds'"},
        Fault{"    method: path\n", "", "12:5: method 'pt' lacks 'method'"},
        Fault{"samples: 1024, ", "", "21:12: reference lacks 'samples'"},
        // Types.
        Fault{"[3, 1, 2]", "[3, one]", "15:12: a seed must be a decimal integer from 0 to 9223"},
        Fault{"[3, 1, 2]", "010", "15:8: seeds, a count or a list, must be a decimal integer"},
        Fault{"[3, 1, 2]", "0x10", "15:8: seeds, a count or a list, must be a decimal integer"},
        Fault{"[3, 1, 2]", "1e3", "15:8: seeds, a count or a list, must be a decimal integer"},
        Fault{"[3, 1, 2]", "\"3\"", "15:8: seeds, a count or a list, must be a decimal integer"},
        Fault{"[3, 1, 2]", "100001",
              "15:8: seeds, a count or a list, must be a decimal integer from 1 to 100000: found "
              "'100001'"},
        Fault{"[3, 1, 2]", "[]", "15:8: seeds must not be empty"},
        Fault{"[3, 1, 2]", "{min: 2, max: 9, until: {ratio_halfwidth: 0.1}}",
              "15:14: min must be a decimal integer from 3 to"},
        Fault{"[3, 1, 2]", "{min: 5, max: 4, until: {ratio_halfwidth: 0.1}}",
              "15:22: max must be a decimal integer from 5 to"},
        Fault{"[3, 1, 2]", "{min: 5, max: 9, until: {ratio_halfwidth: 0}}",
              "15:50: ratio_halfwidth must be above 0 and at most 1: found '0'"},
        Fault{"[3, 1, 2]", "{min: 5, max: 9}", "15:8: seeds lacks 'until'"},
        Fault{"max_depth: 5", "max_depth: 05", "13:16: max_depth: '05' is not a decimal integer"},
        Fault{"max_depth: 5", "max_depth: [5]", "13:16: max_depth must be a single value: found a"},
        Fault{"exposure: -1.5", "exposure: bright", "7:15: exposure must be a number: found 'bri"},
        Fault{"exposure: -1.5", "exposure: .nan", "7:15: exposure must be a number: found '.nan'"},
        Fault{"exposure: -1.5", "exposure: 1e999", "7:15: exposure must be a number"},
        Fault{"image: {width: 64, height: 48}", "image: 64", "20:8: image must be a map: found '6"},
        Fault{"image: {width: 64, height: 48}", "image:", "20:1: image must be a map: found noth"},
        Fault{"description: Which estimator?", "description: [a]", "2:14: description must be tex"},
        Fault{"name: first-light", "name: a/b", "1:7: name must be 1 to 100 letters"},
        Fault{"  pt:\n", "  reference:\n", "11:3: the label 'reference' stands for"},
        // Values.
        Fault{"width: 64", "width: 0", "20:16: width must be a decimal integer from 1 to 16384"},
        Fault{"width: 64", "width: -64", "20:16: width must be a decimal integer from 1 to 16384"},
        Fault{"width: 64", "width: 16385", "20:16: width must be a decimal integer from 1 to 163"},
        Fault{"samples: 16\n", "samples: 0\n", "17:14: samples must be a decimal integer from 1"},
        Fault{"seconds: 2}", "seconds: 0}", "19:15: seconds must be above 0"},
        Fault{"seconds: 2}", "seconds: 2e6}", "19:15: seconds must be above 0 and at most 1e6"},
        Fault{"clock: wall", "clock: walls",
              "18:27: unknown clock 'walls' (did you mean 'wall'?); known: cpu wall"},
        Fault{"samples: 16\n", "samples: 16\n    clock: cpu\n", "18:5: only a budget in seconds"},
        Fault{"{seconds: 2}", "{seconds: 2, samples: 2}", "19:5: a budget has either"},
        Fault{"{seconds: 2}", "{samples: 16}", "19:5: this budget is listed twice"},
        Fault{"[3, 1, 2]", "[3, 1, 3]", "15:15: seed 3 is listed twice"},
        Fault{"seeds: [3, 1, 2]", "seeds: 2\nsnapshots: 1",
              "16:12: the factor of snapshots must be a decimal integer from 2 to 1000"},
        Fault{"seeds: [3, 1, 2]", "seeds: 2\nsnapshots: {first: 4}",
              "16:12: snapshots lacks 'factor'"},
        Fault{"seeds: [3, 1, 2]", "seeds: 2\nsnapshots: {factor: 2, last: 4}",
              "16:24: unknown key 'last'"},
        Fault{"[70, 71]", "[70, 70]", "21:52: the reference's halves must have different seeds"},
        Fault{"[70, 71]", "[70]", "21:47: the reference's seeds must be a list of two"},
        Fault{"  - {scene: [CornellBox, VeachMIS]}", "  - {}", "23:5: a rule must name an axis"},
        // Syntax.
        Fault{"[3, 1, 2]", "[3, 1", "16:8: "}, Fault{"methods:", "methods: {", "11:3: "},
        Fault{"name: first-light", "name: first-light\n---\nname: second",
              "3:1: a second document"},
        Fault{"name: first-light", "? [a, b]\n: 3", "1:3: a key must be a plain word"}));

TEST_F(ExperimentFileTest, KnownKeysAreListedWithAnUnknownOne) {
    EXPECT_THAT(complaint(changed("seeds: [", "sedes: [")), EndsWith(kTopKeys));
}

TEST_F(ExperimentFileTest, AMissingFileIsNotFound) {
    try {
        read_experiment_yaml("/nowhere/experiment.yaml");
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::NotFound);
        EXPECT_THAT(e.what(), HasSubstr("/nowhere/experiment.yaml"));
    }
}

TEST_F(ExperimentFileTest, AnEmptyFileIsSaidToBeEmpty) {
    EXPECT_EQ(complaint(""), "1:1: the file is empty");
}

TEST_F(ExperimentFileTest, AliasesThatExpandWithoutBoundAreRefused) {
    std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 9; ++i) {
        const std::string n = std::to_string(i);
        bomb += "a" + n + ": &a" + n + " [";
        for (int k = 0; k < 9; ++k) bomb += "*a" + std::to_string(i - 1) + ", ";
        bomb += "]\n";
    }
    EXPECT_THAT(complaint(bomb), HasSubstr("more than 100000 values"));
}

TEST_F(ExperimentFileTest, DeepNestingIsRefused) {
    EXPECT_THAT(complaint("a: " + std::string(40, '[') + std::string(40, ']')),
                HasSubstr("nested deeper than 32 levels"));
}

TEST_F(ExperimentFileTest, SetReplacesAndAddsValues) {
    const ExperimentYaml e =
        read(kComplete, {"methods.pt.max_depth=9", "methods.bsdf.rr_depth=2", "image.width=100",
                         "seeds=2", "reference.samples=7", "scenes.VeachMIS.exposure=2",
                         "scenes.CornellBox.image.height=10", "budgets.0.samples=5",
                         "description=\"a: b=c\"", "scenes.0.parameters.max_depth=1"});
    EXPECT_EQ(to_map(e.methods[1].parameters).at("max_depth"), ParameterValue(std::int64_t{9}));
    EXPECT_EQ(to_map(e.methods[0].parameters).at("rr_depth"), ParameterValue(std::int64_t{2}));
    EXPECT_EQ(e.scenes[0].image.width, 100);
    EXPECT_EQ(e.scenes[0].image.height, 10);
    EXPECT_EQ(to_map(e.scenes[0].parameters).at("max_depth"), ParameterValue(std::int64_t{1}));
    EXPECT_EQ(e.scenes[1].exposure, 2);
    EXPECT_EQ(e.seeds.size(), 2U);
    EXPECT_EQ(e.reference.samples, 7);
    EXPECT_EQ(e.budgets[0].value, Budget(SampleBudget{5}));
    EXPECT_EQ(e.description, "a: b=c");
}

TEST_F(ExperimentFileTest, SetOfAnExposureMakesABareSceneAMap) {
    EXPECT_EQ(read(kComplete, {"scenes.CornellBox.exposure=3"}).scenes[0].exposure, 3);
}

TEST_F(ExperimentFileTest, SetCanReplaceAWholeList) {
    const ExperimentYaml e = read(kComplete, {"budgets=[{samples: 1}, {samples: 2}]"});
    EXPECT_EQ(e.budgets.size(), 2U);
}

TEST_F(ExperimentFileTest, SetAddsASectionThatTheFileLeavesOut) {
    const ExperimentYaml e =
        read(changed("image: {width: 64, height: 48}\n", ""), {"image.width=32"});
    EXPECT_EQ(e.scenes[0].image.width, 32);
    EXPECT_EQ(e.scenes[0].image.height, 480);
}

TEST_F(ExperimentFileTest, SetOfWhatIsNotThereSaysWhatIs) {
    EXPECT_EQ(complaint(kComplete, {"methods.ptt.max_depth=3"}),
              "--set methods.ptt.max_depth=3: unknown key 'ptt' (did you mean 'pt'?); "
              "known: bsdf pt");
    EXPECT_EQ(complaint(kComplete, {"scenes.Sponza.exposure=3"}),
              "--set scenes.Sponza.exposure=3: unknown key 'Sponza'; known: CornellBox VeachMIS");
    EXPECT_THAT(complaint(kComplete, {"sceens=[A]"}),
                StartsWith("--set sceens=[A]: unknown key 'sceens' (did you mean 'scenes'?)"));
    EXPECT_THAT(complaint(kComplete, {"budgets.7.samples=3"}),
                StartsWith("--set budgets.7.samples=3: unknown key '7'; known: 0 1 2"));
    EXPECT_THAT(complaint(kComplete, {"image.depth=3"}),
                StartsWith("--set image.depth=3: unknown key 'depth'; known: width height"));
}

TEST_F(ExperimentFileTest, SetWithoutValueOrWithAWrongOneNamesItself) {
    EXPECT_EQ(complaint(kComplete, {"seeds"}), "--set seeds: must be PATH=VALUE");
    EXPECT_THAT(complaint(kComplete, {"seeds="}), StartsWith("--set seeds=: "));
    EXPECT_THAT(complaint(kComplete, {"seeds=[1"}), StartsWith("--set seeds=[1: "));
    EXPECT_THAT(complaint(kComplete, {"image.width=wide"}),
                StartsWith("--set image.width=wide: width must be a decimal integer"));
}

TEST(Suggestion, OnlyACloseNameIsSuggested) {
    EXPECT_EQ(unknown_name("scene", "VeachMS", {"Box", "VeachMIS"}),
              "unknown scene 'VeachMS' (did you mean 'VeachMIS'?); known: Box VeachMIS");
    EXPECT_EQ(unknown_name("scene", "Sponza", {"Box"}), "unknown scene 'Sponza'; known: Box");
    EXPECT_EQ(unknown_name("scene", "Sponza", {}), "unknown scene 'Sponza'; known:");
}

}  // namespace
}  // namespace misbench
