// Every verb of misbench and the effect of each of its options, as processes.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "renderer/image/image.h"
#include "results/store.h"
#include "tests/support/process.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kExperiment = R"(name: tiny
description: A <tiny> experiment
scenes: [CornellBox, Box/LightTop]
image: {width: 16, height: 12}
methods:
  nee: {method: path, max_depth: 3, bsdf: false}
  mis: {method: path, max_depth: 3}
baseline: nee
seeds: 4
budgets: [{samples: 2}, {samples: 8}]
reference: {method: mis, samples: 64}
metrics: [relmse.eps0.01, mse]
)";

class CliTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        std::string name = (fs::temp_directory_path() / "misbench_cli_XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder_ = name;
        fs::permissions(folder_, fs::perms::all);
        std::ofstream(file("tiny.yaml")) << kExperiment;
        first_run_ = misbench({"run", file("tiny.yaml"), "--store", file("store"), "--workers", "2",
                               "--threads-per-worker", "3", "--progress", "always"});
    }
    static void TearDownTestSuite() { fs::remove_all(folder_); }

    static std::string file(const std::string& name) { return (folder_ / name).string(); }

    static Outcome misbench(std::vector<std::string> arguments,
                            const ProcessOptions& options = {}) {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, folder_, options).wait();
    }

    // Exit code and exactly one line on stderr, which contains `message`.
    static void expect_error(const Outcome& outcome, int exit_code, const std::string& message) {
        EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }

    static Image render(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"render", "CornellBox", "-o", file("image.exr")});
        const bool has_size = std::ranges::find(arguments, "--size") != arguments.end();
        if (!has_size) arguments.insert(arguments.end(), {"--size", "16x12"});
        const Outcome outcome = misbench(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        return read_exr(file("image.exr"));
    }

    // The Cornell box, for a test to change.
    static nlohmann::json cornell_box() {
        return nlohmann::json::parse(std::ifstream(MISBENCH_SCENES "/CornellBox/CornellBox.json"));
    }
    static std::string write_scene(const std::string& name, const nlohmann::json& scene) {
        fs::create_directories(file("changed"));
        std::ofstream(file("changed/" + name + ".json")) << scene.dump();
        return file("changed/" + name + ".json");
    }
    // The kinds of the warnings of `scene check`.
    static std::vector<std::string> warnings_of(const std::string& scene) {
        const Outcome outcome = misbench({"scene", "check", scene, "--json", "--threads", "2"});
        EXPECT_EQ(outcome.err, "");
        std::vector<std::string> kinds;
        const auto json = nlohmann::json::parse(outcome.out);
        for (const auto& warning : json["warnings"]) kinds.push_back(warning["kind"]);
        EXPECT_EQ(outcome.exit_code, kinds.empty() ? 0 : 1);
        EXPECT_GE(json["render"]["passes"], 1);
        return kinds;
    }

    static inline fs::path folder_;
    static inline Outcome first_run_;
};

// --- usage ---------------------------------------------------------------------------------------

TEST_F(CliTest, VersionAndHelpAreResults) {
    EXPECT_THAT(misbench({"--version"}).out, StartsWith("misbench "));
    EXPECT_EQ(misbench({"--version"}).exit_code, 0);
    EXPECT_THAT(misbench({"--help"}).out, HasSubstr("130 interrupted"));
    for (const char* verb :
         {"list",   "render", "scene",   "plan",    "run",      "table", "sql",
          "claims", "report", "compare", "bias",    "selftest", "diff",  "explain",
          "import", "export", "merge",   "reindex", "status",   "replay"}) {
        const Outcome help = misbench({verb, "--help"});
        EXPECT_EQ(help.exit_code, 0) << verb;
        EXPECT_THAT(help.out, HasSubstr("Usage")) << verb;
    }
}

TEST_F(CliTest, WrongUsageIsOneLineAndExitCodeTwo) {
    expect_error(misbench({}), 2, "subcommand");
    expect_error(misbench({"tabel"}), 2, "unknown verb 'tabel' (did you mean 'table'?); known: ");
    expect_error(misbench({"scene", "chek"}), 2, "unknown verb 'chek' (did you mean 'check'?)");
    expect_error(misbench({"scene", "check"}), 2, "scene is required");
    expect_error(misbench({"list", "shapes"}), 2, "shapes");
    expect_error(misbench({"table"}), 2, "store");
    expect_error(misbench({"table", file("store"), "--format", "pdf"}), 2, "pdf");
    expect_error(misbench({"run", file("tiny.yaml")}), 2, "--store");
    expect_error(misbench({"run", file("tiny.yaml"), "--store", "x", "--workers", "0"}), 2,
                 "--workers");
    expect_error(misbench({"table", file("store"), "--rows", "scene", "--cols", "scene"}), 2,
                 "rows and columns");
}

// --- list ----------------------------------------------------------------------------------------

TEST_F(CliTest, ListShowsWhatAnExperimentCanName) {
    const std::map<std::string, std::string> known{{"methods", "path"},
                                                   {"heuristics", "power"},
                                                   {"factors", "correction"},
                                                   {"metrics", "relmse.eps0.01"},
                                                   {"scenes", "Box/LightTop"}};
    for (const auto& [what, name] : known) {
        const Outcome text = misbench({"list", what});
        EXPECT_EQ(text.exit_code, 0);
        EXPECT_THAT(text.out, HasSubstr(name));
        const auto json = nlohmann::json::parse(misbench({"list", what, "--json"}).out);
        EXPECT_THAT(json.dump(), HasSubstr("\"" + name + "\""));
        EXPECT_GE(json.size(), 2U) << what;
    }
}

TEST_F(CliTest, ListOfMetricsSaysWhatIsBetterAndHowTheyAggregate) {
    EXPECT_THAT(misbench({"list", "metrics"}).out,
                AllOf(HasSubstr("flip.hdr.ppd67"), HasSubstr("less is better  mean over seeds, "
                                                             "geometric mean of ratios across")));
    const auto json = nlohmann::json::parse(misbench({"list", "metrics", "--json"}).out);
    const auto mean = std::ranges::find(json, "mean", [](const auto& m) { return m.at("id"); });
    ASSERT_NE(mean, json.end());
    EXPECT_EQ(mean->at("better"), "none");
    EXPECT_EQ(mean->at("aggregation"), "mean over seeds");
    EXPECT_EQ(mean->at("has_map"), false);
}

TEST_F(CliTest, ScenesComeFromTheFolderOfTheOptionOrTheEnvironment) {
    fs::create_directories(file("scenes/Mine"));
    std::ofstream(file("scenes/Mine/Mine.json")) << R"({"cameras": [], "objects": []})";
    EXPECT_THAT(misbench({"list", "scenes", "--scenes", file("scenes")}).out, StartsWith("Mine "));
    EXPECT_THAT(
        misbench({"list", "scenes"}, {.environment = {{"MISBENCH_SCENES", file("scenes")}}}).out,
        StartsWith("Mine "));
    expect_error(misbench({"list", "scenes", "--scenes", file("nowhere")}), 2, "not a folder");
    expect_error(misbench({"plan", file("tiny.yaml"), "--scenes", file("scenes")}), 2,
                 "tiny.yaml:3:10: unknown scene 'CornellBox'; known: Mine");
}

// --- scene ---------------------------------------------------------------------------------------

TEST_F(CliTest, SceneInfoShowsWhatASceneRequires) {
    const Outcome text = misbench({"scene", "info", "VeachMIS"});
    EXPECT_EQ(text.exit_code, 0) << text.err;
    EXPECT_THAT(text.out, AllOf(HasSubstr("\ntriangles      1938\n"), HasSubstr("triangle 1920"),
                                HasSubstr("generic 9"), HasSubstr("22.9° (vertical), pinhole"),
                                HasSubstr("method path    estimates all light\n")));
    const auto json = nlohmann::json::parse(misbench({"scene", "info", "VeachMIS", "--json"}).out);
    EXPECT_EQ(json["triangles"], 1938);
    EXPECT_EQ(json["lights"]["types"]["triangle"]["n"], 1920);
    EXPECT_EQ(json["materials"]["types"]["generic"]["front"], 9);
    EXPECT_EQ(json["plain_loop"], true);
    EXPECT_EQ(json["limits"]["path"], "");
}

TEST_F(CliTest, ARefusedSceneIsNamedAndEndsWithExitCodeTwo) {
    nlohmann::json box = cornell_box();
    write_scene("Good", box);
    box["objects"][1]["type"] = "hair";
    const std::string refused = write_scene("Refused", box);
    expect_error(misbench({"scene", "info", refused}), 2, "Refused.json': objects[1].type: ");
    expect_error(misbench({"scene", "check", refused}), 2, "Refused.json': objects[1].type: ");

    const Outcome all = misbench({"scene", "info", "--scenes", file("changed")});
    EXPECT_EQ(all.exit_code, 2);
    EXPECT_THAT(all.out, AllOf(HasSubstr("\nGood   36 "), HasSubstr("\nRefused  refused: scene '"),
                               HasSubstr("objects[1].type: ")));
    const auto json = nlohmann::json::parse(
        misbench({"scene", "info", "--scenes", file("changed"), "--json"}).out);
    EXPECT_EQ(json[0]["triangles"], 36);
    EXPECT_THAT(json[1]["refused"].get<std::string>(), HasSubstr("objects[1].type: "));
    fs::remove_all(file("changed"));
}

TEST_F(CliTest, SceneCheckFindsNothingInACleanScene) {
    const Outcome outcome = misbench({"scene", "check", "CornellBox"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("rendered 128x96 by method path: "), HasSubstr("no warnings\n")));
}

TEST_F(CliTest, SceneCheckNamesTheMeshThatIsWrong) {
    nlohmann::json box = cornell_box();
    // The lamp's winding alone: its normals stay.
    box["objects"][0]["indices"] = {0, 2, 1, 0, 3, 2};
    const Outcome outcome = misbench({"scene", "check", write_scene("Wound", box)});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_THAT(
        outcome.out,
        HasSubstr("\nwarning opposed_emitter_normals: mesh 0 'mesh0' (material 'Light'): "));
}

TEST_F(CliTest, SceneCheckFindsImagesThatStayBlackAndSamplesThatAreNotFinite) {
    nlohmann::json away = cornell_box();
    away["transforms"][0]["rotation"] = {0, 180, 0};
    EXPECT_THAT(warnings_of(write_scene("Away", away)), testing::ElementsAre("black_image"));
    nlohmann::json dark = cornell_box();
    dark["objects"][0].erase("emission");
    EXPECT_THAT(warnings_of(write_scene("Dark", dark)), testing::ElementsAre("no_light"));
    nlohmann::json bright = cornell_box();
    // The light of two edges adds up to more than a float holds.
    const nlohmann::json emission = {{"type", "rgb"}, {"value", {3e38, 3e38, 3e38}}};
    for (auto& material : bright["materials"]) material["baseColor"]["value"] = {1, 1, 1};
    for (auto& object : bright["objects"]) object["emission"] = emission;
    EXPECT_THAT(warnings_of(write_scene("Bright", bright)), testing::ElementsAre("bad_samples"));
}

// --- render --------------------------------------------------------------------------------------

TEST_F(CliTest, EveryRenderOptionChangesTheImageButThreadsDoNot) {
    const Image plain = render({"--spp", "2"});
    EXPECT_EQ(render({"--spp", "2", "--threads", "1"}), plain);
    EXPECT_EQ(render({"--spp", "2", "--threads", "5"}), plain);
    EXPECT_EQ(render({"--spp", "2", "--seed", "1", "--method", "path"}), plain);
    EXPECT_NE(render({"--spp", "3"}), plain);
    EXPECT_NE(render({"--spp", "2", "--seed", "2"}), plain);
    EXPECT_NE(render({"--spp", "2", "--set", "mis=maximum"}), plain);
    EXPECT_NE(render({"--spp", "2", "--set", "max_depth=2", "--set", "nee=false"}),
              render({"--spp", "2", "--set", "max_depth=2"}));
    EXPECT_NE(render({"--spp", "2", "--method", "direct"}), plain);
    EXPECT_EQ(render({"--spp", "2", "--size", "7x5"}).width, 7);
}

TEST_F(CliTest, RenderForATimeCountsItsPasses) {
    for (const char* clock : {"cpu", "wall"}) {
        const Outcome outcome =
            misbench({"render", "CornellBox", "-o", file("timed.exr"), "--size", "16x12",
                      "--seconds", "0.3", "--clock", clock, "--json", "--threads", "1"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const auto record = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(record.at("task").at("budget"),
                  (nlohmann::json{{"seconds", 0.3}, {"clock", clock}}));
        EXPECT_GT(record.at("statistics").at("passes"), 1);
        EXPECT_LE(record.at("statistics").at(std::string(clock) + "_seconds"), 0.3);
    }
}

TEST_F(CliTest, RenderWritesPngAtTheExposureAsked) {
    const auto png = [](const std::string& exposure) {
        misbench({"render", "CornellBox", "--spp", "1", "--size", "16x12", "-o", file("a.png"),
                  "--exposure", exposure});
        return slurp(file("a.png"));
    };
    EXPECT_THAT(png("0"), StartsWith("\x89PNG"));
    EXPECT_NE(png("0"), png("3"));
}

TEST_F(CliTest, RenderOfWhatCannotBeIsRefused) {
    const std::vector<std::string> base{"render", "CornellBox", "-o", file("no.exr")};
    const auto with = [&base](std::vector<std::string> more) {
        more.insert(more.begin(), base.begin(), base.end());
        return misbench(more);
    };
    expect_error(with({}), 2, "--spp or --seconds");
    expect_error(with({"--spp", "1", "--seconds", "1"}), 2, "excludes");
    expect_error(with({"--spp", "0"}), 2, "--spp");
    expect_error(with({"--spp", "1", "--size", "16"}), 2, "--size 16: must be WIDTHxHEIGHT");
    expect_error(with({"--spp", "1", "--size", "16x0"}), 2, "height must be a decimal integer");
    expect_error(with({"--spp", "1", "--method", "mlt"}), 2, "unknown method 'mlt'");
    expect_error(with({"--spp", "1", "--set", "mis=ballance"}), 2, "ballance");
    expect_error(with({"--spp", "1", "--set", "depth=3"}), 2, "depth");
    expect_error(with({"--spp", "1", "--set", "depth"}), 2, "must be KEY=VALUE");
    EXPECT_FALSE(fs::exists(file("no.exr")));
    expect_error(misbench({"render", "CornellBox", "--spp", "1", "-o", file("no.jpg")}), 2,
                 "known: .exr .png");
    expect_error(misbench({"render", "Sponza", "--spp", "1", "-o", file("no.exr")}), 2,
                 "unknown scene 'Sponza'");
    expect_error(misbench({"render", "CornellBox", "--spp", "1", "--size", "4x4", "-o",
                           file("nowhere/no.exr")}),
                 3, "nowhere/no.exr");
}

TEST_F(CliTest, ATruncatedPlyIsNamed) {
    fs::copy(MISBENCH_SCENES "/VeachMIS", file("cut"), fs::copy_options::recursive);
    const std::string mesh = file("cut/meshes/mesh3.ply");
    fs::resize_file(mesh, fs::file_size(mesh) / 2);
    expect_error(
        misbench({"render", file("cut/VeachMIS.json"), "--spp", "1", "-o", file("no.exr")}), 2,
        "mesh3.ply");
}

// --- plan ----------------------------------------------------------------------------------------

TEST_F(CliTest, PlanListsTasksAndWhichAreStored) {
    const Outcome fresh = misbench({"plan", file("tiny.yaml")});
    EXPECT_EQ(fresh.exit_code, 0);
    EXPECT_THAT(fresh.out, AllOf(HasSubstr("tiny: 36 tasks, 0 in the store, 36 to do"),
                                 HasSubstr("a guess"), HasSubstr("reference")));
    const Outcome stored =
        misbench({"plan", file("tiny.yaml"), "--store", file("store"), "--set", "seeds=5"});
    EXPECT_THAT(stored.out, AllOf(HasSubstr("tiny: 44 tasks, 36 in the store, 8 to do"),
                                  Not(HasSubstr("a guess"))));
    EXPECT_THAT(misbench({"plan", file("tiny.yaml"), "--store", file("none")}).out,
                HasSubstr("0 in the store"));
    EXPECT_FALSE(fs::exists(file("none")));
}

TEST_F(CliTest, PlanAsJsonHasTheEffectiveConfiguration) {
    const auto json = nlohmann::json::parse(
        misbench({"plan", file("tiny.yaml"), "--json", "--set", "methods.mis.max_depth=7"}).out);
    EXPECT_EQ(json.at("tasks"), 36);
    EXPECT_EQ(json.at("list").size(), 36U);
    EXPECT_EQ(json.at("configuration").at("methods").at("mis").at("parameters").at("max_depth"), 7);
    EXPECT_GT(json.at("estimated_seconds"), 0);
    EXPECT_EQ(json.at("is_guess"), true);
}

TEST_F(CliTest, AWrongExperimentIsSaidWithItsPlace) {
    std::ofstream(file("broken.yaml")) << "name: [tiny\nscenes: 3\n";
    expect_error(misbench({"plan", file("broken.yaml")}), 2, "broken.yaml:2:");
    expect_error(misbench({"run", file("broken.yaml"), "--store", file("never")}), 2,
                 "broken.yaml:2:");
    EXPECT_FALSE(fs::exists(file("never")));
    expect_error(misbench({"plan", file("gone.yaml")}), 2, "gone.yaml");
    expect_error(misbench({"plan", file("tiny.yaml"), "--set", "seeds=none"}), 2,
                 "--set seeds=none: ");
    std::string lost = kExperiment;
    lost.replace(lost.find("CornellBox"), 10, "CornelBox_");
    std::ofstream(file("lost.yaml")) << lost;
    expect_error(misbench({"plan", file("lost.yaml")}), 2, "lost.yaml:3:10: unknown scene");
}

// --- run -----------------------------------------------------------------------------------------

TEST_F(CliTest, RunPrintsItsTableAndProgress) {
    EXPECT_EQ(first_run_.exit_code, 0) << first_run_.err;
    EXPECT_THAT(first_run_.out, AllOf(HasSubstr("tiny: relmse.eps0.01"), HasSubstr("baseline"),
                                      HasSubstr("4 seeds"), HasSubstr("machine: ")));
    EXPECT_THAT(first_run_.err, AllOf(HasSubstr("\r"), HasSubstr("ETA"), HasSubstr("failed=0")));
    EXPECT_TRUE(fs::exists(file("store/logs/coordinator.log")));
    EXPECT_TRUE(fs::exists(file("store/logs/worker-2.log")));
    EXPECT_FALSE(fs::exists(file("store/logs/worker-3.log")));
    const Store store(file("store"), Store::Access::ReadOnly);
    const Plan plan = store.experiment("tiny");
    EXPECT_EQ(store.run(task_id(plan.cells.back().task))->statistics.threads, 3);
}

TEST_F(CliTest, RunOfAFinishedExperimentStartsNobody) {
    const auto logs_before = slurp(file("store/logs/coordinator.log"));
    const auto start = std::chrono::steady_clock::now();
    const Outcome again = misbench({"run", file("tiny.yaml"), "--store", file("store")});
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_EQ(again.out, first_run_.out);
    EXPECT_EQ(slurp(file("store/logs/coordinator.log")), logs_before);
}

TEST_F(CliTest, RunShowsLogLinesWhereThereIsNoTerminalAndNothingWhenAskedTo) {
    const auto run = [](const std::string& progress) {
        return misbench({"run", file("tiny.yaml"), "--store", file("other" + progress),
                         "--progress", progress, "--set", "seeds=1", "--set",
                         "budgets=[{samples: 1}]", "--set", "reference.samples=1"});
    };
    const Outcome automatic = run("auto");
    EXPECT_EQ(automatic.exit_code, 0) << automatic.err;
    EXPECT_THAT(automatic.err, AllOf(HasSubstr("progress done="), HasSubstr("run ended done=8"),
                                     Not(HasSubstr("\r"))));
    const Outcome quiet = run("never");
    EXPECT_EQ(quiet.exit_code, 0);
    EXPECT_EQ(quiet.err, "");
}

// --- table and report ----------------------------------------------------------------------------

TEST_F(CliTest, TableTakesMetricRowsColumnsAndFormat) {
    const auto table = [](std::vector<std::string> more) {
        more.insert(more.begin(), {"table", file("store")});
        const Outcome outcome = misbench(more);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        return outcome.out;
    };
    EXPECT_EQ(table({}), first_run_.out);
    EXPECT_EQ(table({"--experiment", "tiny"}), first_run_.out);
    EXPECT_THAT(table({"--metric", "mse"}), StartsWith("tiny: mse"));
    EXPECT_THAT(table({"--rows", "budget", "--cols", "scene"}),
                HasSubstr("\nbudget   method   CornellBox"));
    EXPECT_THAT(table({"--rows", "method", "--cols", "budget"}),
                HasSubstr("\nmethod   scene          2 spp"));
    EXPECT_THAT(table({"--format", "markdown"}), HasSubstr("| scene | budget | nee | mis |"));
    EXPECT_THAT(table({"--format", "latex"}), HasSubstr("scene & budget & nee & mis \\\\"));
    EXPECT_THAT(table({"--format", "csv"}),
                HasSubstr("\ntiny,relmse.eps0.01,CornellBox,nee,2 spp,4,4,0,0,0,0,"));
    const auto json = nlohmann::json::parse(table({"--format", "json", "--metric", "mse"}));
    EXPECT_EQ(json.at("metric"), "mse");
    EXPECT_EQ(json.at("cells").size(), 8U);
    EXPECT_EQ(json.at("cells").at(0).at("values").size(), 4U);
}

TEST_F(CliTest, EveryOptionOfATableHasAnEffect) {
    const auto table = [](std::vector<std::string> more) {
        more.insert(more.begin(), "table");
        more.push_back(file("store"));
        const Outcome outcome = misbench(more);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    };
    EXPECT_THAT(table({"--metric", "mse", "--metric", "mse*cpu", "--cols", "metric"}),
                HasSubstr(" mse*cpu"));
    EXPECT_THAT(table({"--where", "method=mis and budget=2spp"}), Not(HasSubstr(" nee")));
    EXPECT_THAT(table({"--ratio-to", "mis"}), HasSubstr("baseline 'mis'"));
    EXPECT_THAT(table({"--ratio-to", "best"}), HasSubstr("a ranking, not a test"));
    EXPECT_THAT(table({"--mean"}), AllOf(HasSubstr("geometric mean of these 2 scenes"),
                                         HasSubstr("geometric mean of scenes like these 2")));
    EXPECT_THAT(table({"--group"}), HasSubstr("geometric mean of this scene of CornellBox"));
    EXPECT_NE(table({"--sort", "mis"}), table({"--sort", "name"}));
    EXPECT_THAT(table({"--hide", "ratio,footer"}), Not(HasSubstr("×")));
    EXPECT_NE(table({"--precision", "1"}), table({"--precision", "5"}));
    EXPECT_THAT(table({"--format", "html"}), StartsWith("<table"));
    EXPECT_THAT(table({"--format", "latex-macros"}), StartsWith("\\newcommand{\\Tiny"));
    expect_error(misbench({"table", file("store"), "--where", "sene=x"}), 2, "known: bsdf budget");
    expect_error(misbench({"table", file("store"), "--where", "seed=99"}), 2, "no seed matches");
    expect_error(misbench({"table", file("store"), "--hide", "all"}), 2, "all");
}

TEST_F(CliTest, SqlAsksAndNeverChanges) {
    const std::string count = "SELECT count(*) AS n FROM comparisons WHERE metric = 'mse'";
    EXPECT_EQ(misbench({"sql", file("store"), count}).out, "n\n4\n");
    EXPECT_EQ(misbench({"sql", file("store"), count, "--format", "csv"}).out, "n\n4\n");
    EXPECT_EQ(misbench({"sql", file("store"), count, "--format", "json"}).out, "[\n{\"n\":4}\n]\n");
    EXPECT_EQ(misbench({"sql", file("store"), count, "--format", "markdown"}).out,
              "| n |\n|---|\n| 4 |\n");
    EXPECT_THAT(misbench({"sql", file("store")}).out, HasSubstr("CREATE VIEW results"));
    expect_error(misbench({"sql", file("store"), "DELETE FROM runs"}), 2, "may only read");
    expect_error(misbench({"sql", file("nowhere"), count}), 2, "nowhere");
}

TEST_F(CliTest, TableOfWhatIsNotThereSaysWhatIs) {
    expect_error(misbench({"table", file("nowhere")}), 2, "nowhere");
    expect_error(misbench({"table", file("store"), "--experiment", "huge"}), 2, "tiny");
    expect_error(misbench({"table", file("store"), "--metric", "psnr"}), 2, "relmse.eps0.01");
}

TEST_F(CliTest, ATableThatStdoutDoesNotTakeIsAnError) {
    const Outcome outcome = misbench({"table", file("store")}, {.stdout_file = "/dev/full"});
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_EQ(outcome.err, "misbench: error: write to stdout: No space left on device\n");
}

TEST_F(CliTest, ReportIsOneFileThatNeedsNothingElse) {
    const Outcome outcome = misbench({"report", file("store")});
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, testing::ContainsRegex("report.html: [0-9.]+ MB, [0-9]+ images\n"));
    const std::string html = slurp(file("store/report.html"));
    EXPECT_THAT(html, AllOf(StartsWith("<!DOCTYPE html>"), HasSubstr("A &lt;tiny&gt; experiment"),
                            HasSubstr("Box/LightTop"), HasSubstr("id=\"block-0\""),
                            HasSubstr("mse"), Not(HasSubstr("{{"))));
    for (const char* outside : {"src=", "href=\"h", "href=\"/", "@import", "url("}) {
        EXPECT_THAT(html, Not(HasSubstr(outside)));
    }
    ASSERT_EQ(
        misbench({"report", file("store"), "-o", file("r.html"), "--experiment", "tiny"}).exit_code,
        0);
    EXPECT_EQ(slurp(file("r.html")), html);
    expect_error(misbench({"report", file("store"), "-o", file("nowhere/r.html")}), 3, "r.html");
    expect_error(misbench({"report", file("store"), "--seeds", "two"}), 2, "--seeds");
    expect_error(misbench({"report", file("store"), "--interval", "2"}), 2, "--watch");
}

TEST_F(CliTest, AWatchedReportEndsWithItsExperiment) {
    const Outcome outcome = misbench(
        {"report", file("store"), "-o", file("watched.html"), "--watch", "--interval", "0.1"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, HasSubstr("36 of 36 tasks done"));
    ASSERT_EQ(misbench({"report", file("store"), "-o", file("once.html")}).exit_code, 0);
    EXPECT_EQ(slurp(file("watched.html")), slurp(file("once.html")));
}

// --- the store -----------------------------------------------------------------------------------

TEST_F(CliTest, StatusCountsTasks) {
    const Outcome outcome = misbench({"status", file("store")});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, testing::ContainsRegex("tiny +36 +36 +0 +0 +0 +0"));
    expect_error(misbench({"status", file("nowhere")}), 2, "nowhere");
}

TEST_F(CliTest, ReindexBringsBackADeletedDatabase) {
    fs::copy(file("store"), file("copy"), fs::copy_options::recursive);
    fs::remove(file("copy/results.sqlite"));
    const Outcome outcome = misbench({"reindex", file("copy")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "36 runs, 1 experiments, 0 damaged\n");
    EXPECT_EQ(misbench({"table", file("copy")}).out, first_run_.out);
    expect_error(misbench({"reindex", file("nowhere")}), 2, "nowhere");
}

TEST_F(CliTest, AReadOnlyStoreIsReadButNotRunIn) {
    fs::copy(file("store"), file("fixed"), fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(file("fixed"))) {
        fs::permissions(entry, entry.is_directory() ? fs::perms(0555) : fs::perms(0444));
    }
    fs::permissions(file("fixed"), fs::perms(0555));
    const ProcessOptions as_other{.as_nobody = ::getuid() == 0};
    EXPECT_EQ(misbench({"table", file("fixed")}, as_other).out, first_run_.out);
    expect_error(misbench({"run", file("tiny.yaml"), "--store", file("fixed")}, as_other), 3,
                 file("fixed"));
    expect_error(misbench({"report", file("fixed")}, as_other), 3, "report.html");
    fs::permissions(file("fixed"), fs::perms(0755));
}

}  // namespace
}  // namespace misbench
