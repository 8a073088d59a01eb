// From an experiment file to a plan, against the real catalogues and small scenes.
#include "experiments/resolve.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "experiments/scene_lookup.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kScene = R"({"cameras": [], "materials": [], "objects": []})";

constexpr const char* kExperiment = R"(name: small
scenes:
  - A
  - scene: Pair/B
    image: {width: 8}
    exposure: 1
    parameters: {max_depth: 2}
methods:
  bsdf: {method: path, nee: false}
  pt: {method: path, max_depth: 5}
  direct: {method: direct}
seeds: [5, 6]
budgets: [{samples: 4}, {samples: 8}]
image: {width: 16, height: 12}
reference: {method: pt, samples: 64, max_depth: 4}
)";

class ResolveTest : public testing::Test {
 protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  testing::UnitTest::GetInstance()->current_test_info()->name();
        fs::remove_all(folder_);
        write("scenes/A/A.json", kScene);
        write("scenes/Pair/B.json", std::string(kScene) + "\n");
    }
    void TearDown() override { fs::remove_all(folder_); }

    void write(const fs::path& file, const std::string& text) {
        fs::create_directories((folder_ / file).parent_path());
        std::ofstream(folder_ / file) << text;
    }

    Plan plan(const std::string& text, const std::vector<std::string>& overrides = {}) {
        write("experiment.yaml", text);
        return resolve(read_experiment_yaml(folder_ / "experiment.yaml", overrides),
                       folder_ / "scenes");
    }

    std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
        try {
            plan(text, overrides);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), Errc::InvalidArgument);
            const std::string message = e.what();
            const std::string prefix = (folder_ / "experiment.yaml").string() + ":";
            return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
        }
        return "no complaint";
    }

    fs::path folder_;
};

std::string changed(const std::string& from, const std::string& to) {
    std::string text = kExperiment;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

std::vector<std::string> labels_of(const Plan& plan) {
    std::vector<std::string> labels;
    for (const Cell& cell : plan.cells) {
        labels.push_back(std::to_string(cell.seed) + " " + to_string(cell.budget) + " " +
                         cell.scene + " " + cell.method);
    }
    return labels;
}

TEST_F(ResolveTest, CellsHaveReferencesFirstThenSeedsOutermostAndMethodsInnermost) {
    const std::vector<std::string> labels = labels_of(plan(kExperiment));
    ASSERT_EQ(labels.size(), 4U + 2 * 2 * 2 * 3);
    EXPECT_THAT(
        std::vector(labels.begin(), labels.begin() + 11),
        ElementsAre("1000001 64 spp A reference", "1000002 64 spp A reference",
                    "1000001 64 spp Pair/B reference", "1000002 64 spp Pair/B reference",
                    "5 4 spp A bsdf", "5 4 spp A pt", "5 4 spp A direct", "5 4 spp Pair/B bsdf",
                    "5 4 spp Pair/B pt", "5 4 spp Pair/B direct", "5 8 spp A bsdf"));
    EXPECT_EQ(labels.back(), "6 8 spp Pair/B direct");
}

TEST_F(ResolveTest, ATaskHasAllThatItTakesToDoIt) {
    const Plan p = plan(kExperiment);
    const Cell& cell = p.cells.at(8);  // Pair/B, pt
    ASSERT_EQ(cell.method, "pt");
    EXPECT_EQ(cell.role, Role::Test);
    EXPECT_EQ(cell.task.scene, "Pair/B");
    EXPECT_EQ(fs::path(cell.task.scene_file), fs::canonical(folder_ / "scenes/Pair/B.json"));
    EXPECT_EQ(cell.task.scene_hash, scene_content_hash(folder_ / "scenes/Pair/B.json"));
    EXPECT_EQ(cell.task.width, 8);
    EXPECT_EQ(cell.task.height, 12);
    EXPECT_EQ(cell.task.method, "path");
    EXPECT_GE(cell.task.method_version, 1);
    EXPECT_EQ(cell.task.seed, 5);
    EXPECT_EQ(cell.task.budget, Budget(SampleBudget{4}));
}

TEST_F(ResolveTest, SceneOverridesLabelOverridesDefault) {
    const Plan p = plan(kExperiment);
    const auto depth = [&p](std::size_t cell) { return p.cells.at(cell).task.parameters; };
    EXPECT_EQ(depth(5).at("max_depth"), ParameterValue(std::int64_t{5}));  // A, pt
    EXPECT_EQ(depth(8).at("max_depth"), ParameterValue(std::int64_t{2}));  // Pair/B, pt
    EXPECT_EQ(depth(4).at("nee"), ParameterValue(false));
    EXPECT_EQ(depth(5).at("nee"), ParameterValue(true));                   // the default, filled in
    EXPECT_FALSE(depth(9).contains("max_depth"));                          // direct declares none
    EXPECT_EQ(depth(0).at("max_depth"), ParameterValue(std::int64_t{4}));  // reference over label
    EXPECT_EQ(depth(2).at("max_depth"), ParameterValue(std::int64_t{2}));  // scene over reference
}

TEST_F(ResolveTest, ThePlanKeepsTheUsersOrderAndFillsInDefaults) {
    const Plan p = plan(kExperiment);
    EXPECT_THAT(p.methods, ElementsAre("bsdf", "pt", "direct"));
    EXPECT_EQ(p.baseline, "bsdf");
    EXPECT_THAT(p.metrics, ElementsAre("relmse.eps0.01"));
    EXPECT_EQ(p.scenes.at(1), (PlannedScene{.name = "Pair/B", .exposure = 1}));
    EXPECT_EQ(plan_from_json(plan_to_json(p)), p);
}

TEST_F(ResolveTest, TheConfigurationIsTheEffectiveFile) {
    const auto json =
        nlohmann::json::parse(plan(kExperiment, {"methods.pt.max_depth=7"}).configuration);
    EXPECT_EQ(json.at("methods").at("pt").at("parameters").at("max_depth"), 7);
    EXPECT_EQ(json.at("methods").at("pt").at("parameters").at("nee"), true);
    EXPECT_EQ(json.at("methods").at("pt").at("method"), "path");
    EXPECT_EQ(json.at("scenes").at(1).at("image").at("width"), 8);
    EXPECT_EQ(json.at("scenes").at(0).at("sha256"),
              scene_content_hash(folder_ / "scenes/A/A.json"));
    EXPECT_EQ(json.at("seeds"), (nlohmann::json{5, 6}));
    EXPECT_EQ(json.at("reference").at("seeds"), (nlohmann::json{1000001, 1000002}));
    EXPECT_EQ(json.at("reference").at("samples"), 64);
}

TEST_F(ResolveTest, TwoLabelsForTheSameParametersShareTheirTask) {
    const Plan p = plan(changed("direct: {method: direct}", "same: {method: path, max_depth: 5}"));
    EXPECT_EQ(task_id(p.cells.at(5).task), task_id(p.cells.at(6).task));
    EXPECT_NE(task_id(p.cells.at(4).task), task_id(p.cells.at(5).task));
}

TEST_F(ResolveTest, AnEditOfTheSceneChangesItsTasks) {
    const std::string before = task_id(plan(kExperiment).cells.at(4).task);
    write("scenes/A/A.json", std::string(kScene) + " ");
    EXPECT_NE(task_id(plan(kExperiment).cells.at(4).task), before);
}

TEST_F(ResolveTest, ASceneByPathIsRelativeToTheFile) {
    write("mine/C.json", kScene);
    const Plan p = plan(changed("- A\n", "- mine/C.json\n"));
    EXPECT_EQ(p.scenes.at(0).name, "C");
    EXPECT_EQ(fs::path(p.cells.at(0).task.scene_file), fs::canonical(folder_ / "mine/C.json"));
}

TEST_F(ResolveTest, IncludeKeepsWhatMatchesOneOfItsRules) {
    const Plan p = plan(std::string(kExperiment) +
                        "include: [{scene: A, method: [pt, bsdf], seed: 5}, {budget: {samples: 8}, "
                        "method: direct, seed: 6, scene: A}]\n");
    EXPECT_THAT(
        labels_of(p),
        ElementsAre("1000001 64 spp A reference", "1000002 64 spp A reference", "5 4 spp A bsdf",
                    "5 4 spp A pt", "5 8 spp A bsdf", "5 8 spp A pt", "6 8 spp A direct"));
}

TEST_F(ResolveTest, ExcludeDropsWhatMatchesAndTheReferenceOfASceneWithoutCells) {
    const Plan p = plan(std::string(kExperiment) +
                        "exclude: [{scene: Pair/B}, {seed: 6}, {budget: {samples: 8}}, "
                        "{method: direct}]\n");
    EXPECT_THAT(labels_of(p),
                ElementsAre("1000001 64 spp A reference", "1000002 64 spp A reference",
                            "5 4 spp A bsdf", "5 4 spp A pt"));
}

constexpr const char* kClaims = R"(claims:
  - {claim: faster, where: Fig. 1, method: pt, expect: less, paper: 0.5}
  - claim: never worse
    scenes: [Pair/B]
    method: direct
    against: pt
    metric: seconds_per_pass
    budget: {samples: 8}
    over: worst
    expect: not_more
    margin: 0.1
    paper: 0.9
    note: "a | note"
)";

TEST_F(ResolveTest, ClaimsHaveTheirDefaultsFilledInAndAreKeptInThePlan) {
    const Plan p = plan(std::string(kExperiment) + kClaims);
    const Claim first{.text = "faster",
                      .where = "Fig. 1",
                      .scenes = {"A", "Pair/B"},
                      .method = "pt",
                      .against = "bsdf",
                      .metric = "relmse.eps0.01",
                      .budget = SampleBudget{4},
                      .expect = Expectation::Less,
                      .paper = {{"A", 0.5}, {"Pair/B", 0.5}},
                      .note = ""};
    const Claim second{.text = "never worse",
                       .where = "",
                       .scenes = {"Pair/B"},
                       .method = "direct",
                       .against = "pt",
                       .metric = kSecondsPerPass,
                       .budget = SampleBudget{8},
                       .over = ClaimOver::Worst,
                       .expect = Expectation::NotMore,
                       .margin = 0.1,
                       .paper = {{"", 0.9}},
                       .note = "a | note"};
    EXPECT_THAT(p.claims, ElementsAre(first, second));
    EXPECT_EQ(plan_from_json(plan_to_json(p)), p);
    EXPECT_EQ(nlohmann::json::parse(p.configuration).at("claims").size(), 2U);
}

TEST_F(ResolveTest, APlanOfABuildWithoutClaimsIsRead) {
    const Plan p = plan(kExperiment);
    nlohmann::json json = plan_to_json(p);
    json.erase("claims");
    EXPECT_EQ(plan_from_json(json), p);
}

TEST_F(ResolveTest, SnapshotsAreTakenOfTestedRunsOnly) {
    const Plan without = plan(kExperiment);
    const Plan with = plan(std::string(kExperiment) + "snapshots: {factor: 4, first: 2}\n");
    EXPECT_THAT(with.configuration, HasSubstr(R"("snapshots":{"factor":4,"first":2})"));
    ASSERT_EQ(with.cells.size(), without.cells.size());
    for (std::size_t i = 0; i < with.cells.size(); ++i) {
        Cell expected = without.cells[i];
        if (expected.role == Role::Test) {
            expected.task.snapshots = SnapshotLadder{.first = 2, .factor = 4};
        }
        EXPECT_EQ(with.cells[i], expected);
    }
    EXPECT_EQ(plan_from_json(plan_to_json(with)), with);
}

TEST_F(ResolveTest, AClaimIsAboutTheScenesThatHaveBothMethods) {
    const std::string rule = "exclude: [{scene: A, method: pt}]\n";
    EXPECT_THAT(plan(kExperiment + rule + kClaims).claims.front().scenes, ElementsAre("Pair/B"));
    EXPECT_EQ(complaint(kExperiment + rule +
                        "claims: [{claim: x, method: pt, scenes: [A], expect: less}]\n"),
              "17:42: the experiment leaves out 'pt' in scene 'A' with 4 spp");
    EXPECT_EQ(complaint(std::string(kExperiment) + "exclude: [{method: pt}]\n" + kClaims),
              "18:5: the experiment has no scene with both 'pt' and 'bsdf' with 4 spp");
}

TEST_F(ResolveTest, AProfileIsAnExperimentOfItsOwn) {
    const std::string text = std::string(kExperiment) +
                             "profiles: {laptop: {seeds: 2}, paper: {seeds: 3, methods: {pt: "
                             "{max_depth: 6}}}}\n";
    write("profiles.yaml", text);
    const Plan p =
        resolve(read_experiment_yaml(folder_ / "profiles.yaml", {}, "paper"), folder_ / "scenes");
    EXPECT_EQ(p.experiment, "small-paper");
    EXPECT_EQ(p.cells.size(), 4U + 3 * 2 * 2 * 3);
    EXPECT_EQ(p.cells.at(5).task.parameters.at("max_depth"), ParameterValue(std::int64_t{6}));
    EXPECT_EQ(nlohmann::json::parse(p.configuration).at("profile"), "paper");
    EXPECT_EQ(plan(text).experiment, "small");
}

TEST_F(ResolveTest, APlanWithASeedRuleHasAllSeedsThatTheRuleAllows) {
    const std::string text = std::string(kExperiment) +
                             "profiles: {laptop: {}, paper: {seeds: {min: 3, max: 7, until: "
                             "{ratio_halfwidth: 0.25}}}}\n";
    write("rule.yaml", text);
    const Plan p =
        resolve(read_experiment_yaml(folder_ / "rule.yaml", {}, "paper"), folder_ / "scenes");
    EXPECT_EQ(p.seed_rule, (SeedRule{.min = 3, .max = 7, .ratio_halfwidth = 0.25}));
    EXPECT_EQ(p.cells.size(), 4U + 7 * 2 * 2 * 3);
    const auto configuration = nlohmann::json::parse(p.configuration);
    EXPECT_EQ(configuration.at("profile"), "paper");
    EXPECT_EQ(configuration.at("seeds"), plan_to_json(p).at("seed_rule"));
    EXPECT_EQ(plan_from_json(plan_to_json(p)), p);
    EXPECT_EQ(plan(text).seed_rule, std::nullopt);
}

struct Fault {
    const char* from;
    const char* to;
    const char* complaint;
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.to; }

class ResolveFault : public ResolveTest, public testing::WithParamInterface<Fault> {
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  ("resolve" + std::to_string(reinterpret_cast<std::uintptr_t>(GetParam().to)));
        write("scenes/A/A.json", kScene);
        write("scenes/Pair/B.json", std::string(kScene) + "\n");
    }
};

TEST_P(ResolveFault, IsSaidWithItsPlace) {
    EXPECT_THAT(complaint(changed(GetParam().from, GetParam().to)),
                testing::StartsWith(GetParam().complaint));
}

INSTANTIATE_TEST_SUITE_P(
    All, ResolveFault,
    testing::Values(
        Fault{"- A\n", "- AA\n", "3:5: unknown scene 'AA' (did you mean 'A'?); known: A Pair/B"},
        Fault{"- A\n", "- nowhere/A.json\n", "3:5: unknown scene 'nowhere/A.json'"},
        Fault{"- A\n", "- A\n  - A\n", "4:5: a second scene of the name 'A'"},
        Fault{"{method: direct}", "{method: pathh}",
              "11:20: unknown method 'pathh' (did you mean 'path'?); known: "},
        Fault{"nee: false", "neee: false",
              "9:24: unknown parameter of method 'path', 'neee' (did you mean 'nee'?); known: "},
        Fault{"nee: false", "nee: 3", "9:29: "},
        Fault{"nee: false", "mis: ballance", "9:29: unknown MIS heuristic 'ballance'; known: "},
        Fault{"max_depth: 5", "max_depth: deep", "10:33: "},
        Fault{"{max_depth: 2}", "{max_dept: 2}", "7:18: unknown parameter 'max_dept' (did you me"},
        Fault{"{max_depth: 2}", "{max_depth: 2.5}", "7:29: "},
        Fault{"method: pt,", "method: ptt,", "15:21: unknown method 'ptt' (did you mean 'pt'?)"},
        Fault{"samples: 64, max", "samples: 64, mox", "15:38: unknown parameter of method 'path'"},
        Fault{"samples: 64", "samples: 64, seeds: [5, 99]",
              "15:46: the reference's seed 5 is also a tested one"},
        Fault{"\nimage: {width: 16", "\nbaseline: px\nimage: {width: 16",
              "14:11: unknown baseline 'px' (did you mean 'pt'?); known: bsdf pt direct"},
        Fault{"\nimage: {width: 16", "\nmetrics: [relmse]\nimage: {width: 16",
              "14:11: unknown metric 'relmse'; known: "},
        Fault{"\nimage: {width: 16", "\nmetrics: [mse, mse]\nimage: {width: 16",
              "14:16: metric 'mse' is listed twice"},
        Fault{"\nimage: {width: 16", "\ninclude: [{scene: C}]\nimage: {width: 16",
              "14:19: unknown scene 'C'"},
        Fault{"\nimage: {width: 16", "\ninclude: [{method: px}]\nimage: {width: 16",
              "14:20: unknown method 'px'"},
        Fault{"\nimage: {width: 16", "\nexclude: [{seed: 7}]\nimage: {width: 16",
              "14:18: unknown seed '7'; known: 5 6"},
        Fault{"\nimage: {width: 16", "\nexclude: [{budget: {samples: 9}}]\nimage: {width: 16",
              "14:20: unknown budget '9 spp' (did you mean '4 spp'?); known: 4 spp 8 spp"},
        Fault{"\nimage: {width: 16",
              "\ninclude: [{scene: A}]\nexclude: [{scene: Pair/B}]\nimage: {width: 16",
              "15:11: this rule matches no cell"},
        Fault{"\nimage: {width: 16", "\nexclude: [{seed: 5}, {seed: 6}]\nimage: {width: 16",
              "14:22: no cell is left after this rule"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: px, expect: less}]\nimage: {width: 16",
              "14:29: unknown method 'px' (did you mean 'pt'?); known: bsdf pt direct"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: bsdf, expect: less}]\nimage: {width: 16",
              "14:29: a claim compares 'bsdf' with itself"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: pt, against: px, expect: less}]\nimage: {width: 16",
              "14:42: unknown method 'px'"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: pt, metric: mse, expect: less}]\nimage: {width: 16",
              "14:41: unknown metric of the experiment, 'mse'; known: relmse.eps0.01 "
              "seconds_per_pass"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: pt, scenes: [C], expect: less}]\nimage: {width: 16",
              "14:42: unknown scene 'C'; known: A Pair/B"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: pt, scenes: [A, A], expect: less}]\nimage: {width: 16",
              "14:45: scene 'A' is listed twice"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: pt, budget: {samples: 9}, expect: less}]\nimage: "
              "{width: 16",
              "14:41: unknown budget '9 spp'"},
        Fault{"\nimage: {width: 16",
              "\nclaims: [{claim: x, method: pt, scenes: A, paper: {Pair/B: 2}, expect: less}]\n"
              "image: {width: 16",
              "14:52: unknown scene of the claim, 'Pair/B'; known: A"}));

TEST_F(ResolveTest, AnOverrideThatIsWrongNamesItself) {
    EXPECT_THAT(complaint(kExperiment, {"methods.pt.max_dpth=3"}),
                testing::StartsWith("--set methods.pt.max_dpth=3: unknown parameter"));
    EXPECT_THAT(complaint(kExperiment, {"methods.pt.mis=nonsense"}),
                testing::StartsWith("--set methods.pt.mis=nonsense: unknown MIS heuristic"));
}

TEST_F(ResolveTest, ASceneThatLacksAFileIsSaidWithThePlaceInTheExperiment) {
    write(
        "scenes/A/A.json",
        R"({"cameras": [], "objects": [{"name": "m", "type": "ply", "relativePath": "gone.ply"}]})");
    EXPECT_THAT(complaint(kExperiment),
                testing::AllOf(testing::StartsWith("3:5: "), HasSubstr("gone.ply")));
}

TEST_F(ResolveTest, ExperimentsBeyondTheLimitAreRefused) {
    EXPECT_THAT(complaint(kExperiment, {"seeds=10000"}), HasSubstr("120000 cells"));
}

TEST_F(ResolveTest, TheSceneFolderIsTheOptionOrElseTheEnvironmentsOrElseTheSourceTrees) {
    unsetenv("MISBENCH_SCENES");
    EXPECT_TRUE(fs::exists(scene_folder("") / "CornellBox"));
    setenv("MISBENCH_SCENES", (folder_ / "scenes").c_str(), 1);
    EXPECT_EQ(scene_folder(""), folder_ / "scenes");
    EXPECT_EQ(scene_folder("/"), "/");
    setenv("MISBENCH_SCENES", "/nowhere", 1);
    EXPECT_THROW(scene_folder(""), Error);
    unsetenv("MISBENCH_SCENES");
}

// Those of the extremes name scenes that a program writes; those of figures are no experiments.
bool is_on_our_scenes(const fs::path& file) {
    const fs::path folder = file.parent_path().filename();
    return file.extension() == ".yaml" && folder != "extremes" && folder != "figures" &&
           !is_lab_file(file);
}

TEST(ExperimentFiles, ArePlannedInEveryProfile) {
    int n_plans = 0;
    for (const auto& entry : fs::recursive_directory_iterator(MISBENCH_EXPERIMENTS)) {
        if (!is_on_our_scenes(entry.path())) continue;
        const ExperimentYaml first = read_experiment_yaml(entry.path());
        std::vector<std::string> profiles = first.profile.known;
        if (profiles.empty()) profiles.emplace_back();
        for (const std::string& profile : profiles) {
            const Plan plan = resolve(read_experiment_yaml(entry.path(), {}, profile),
                                      fs::path(MISBENCH_EXPERIMENTS) / "scenes");
            EXPECT_FALSE(plan.cells.empty()) << entry.path() << ' ' << profile;
            ++n_plans;
        }
    }
    EXPECT_GT(n_plans, 30);
}

}  // namespace
}  // namespace misbench
