// What a render shows of its samples, as processes: misbench replay and misbench render
// --techniques.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "renderer/image/image.h"
#include "results/store.h"
#include "tests/support/exr_layers.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kExperiment = R"(name: shown
scenes: [Box.json]
image: {width: 16, height: 12}
methods:
  bdpt: {method: bdpt, max_depth: 4}
  vcm: {method: vcm, max_depth: 4}
  direct: {method: direct}
  path: {method: path, bsdf: false}
baseline: direct
seeds: 6
budgets: [{samples: 3}]
reference: {method: bdpt, samples: 4}
metrics: [mse]
)";

// The Cornell box. With a bright lamp and white walls, light of two edges is more than a float
// holds.
std::string box(bool is_bright = false) {
    auto scene =
        nlohmann::json::parse(std::ifstream(MISBENCH_SCENES "/CornellBox/CornellBox.json"));
    if (is_bright) {
        const nlohmann::json emission = {{"type", "rgb"}, {"value", {3e38, 3e38, 3e38}}};
        for (auto& material : scene["materials"]) material["baseColor"]["value"] = {1, 1, 1};
        for (auto& object : scene["objects"]) object["emission"] = emission;
    }
    return scene.dump();
}

class ReplayTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        run_experiment("store", box());
        run_experiment("bright", box(true));
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static std::string file(const std::string& name) { return folder_->path() / name; }
    static void run_experiment(const std::string& name, const std::string& scene) {
        folder_->write(name + "-scenes/Box.json", scene);
        const fs::path yaml = folder_->write(name + "-scenes/shown.yaml", kExperiment);
        misbench({"run", yaml, "--store", file(name), "--workers", "1"});
    }

    static Outcome misbench(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, folder_->path()).wait();
    }
    static void expect_refused(const std::vector<std::string>& arguments,
                               const std::string& message) {
        const Outcome outcome = misbench(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }
    static nlohmann::json replay(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "replay");
        arguments.emplace_back("--json");
        const Outcome outcome = misbench(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        return nlohmann::json::parse(outcome.out);
    }
    // One of the runs of three samples a pixel.
    static std::string run_of(const std::string& store, const std::string& method) {
        const Store opened(file(store), Store::Access::ReadOnly);
        for (const auto& [id, summary] : opened.run_summaries()) {
            const Task task = opened.run(id)->task;
            if (task.method == method && task.budget == Budget(SampleBudget{3})) return id;
        }
        ADD_FAILURE() << "no run of " << method;
        return "";
    }

    static inline std::unique_ptr<TemporaryFolder> folder_;
};

void expect_near(const nlohmann::json& a, const nlohmann::json& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t c = 0; c < a.size(); ++c) {
        const auto expected = b[c].get<double>();
        EXPECT_NEAR(a[c].get<double>(), expected, 1e-5 * std::abs(expected) + 1e-12);
    }
}

// --- replay --------------------------------------------------------------------------------------

TEST_F(ReplayTest, ShowsTheVerySamplesOfARun) {
    for (const char* method : {"bdpt", "vcm", "direct"}) {
        const std::string run = run_of("store", method);
        const Image image = Store(file("store"), Store::Access::ReadOnly).run_image(run);
        std::vector<double> mean(3);
        for (const char* sample : {"0", "1", "2"}) {
            const auto json =
                replay({run, "--store", file("store"), "--pixel", "7,9", "--sample", sample});
            EXPECT_EQ(json["run"], run);
            EXPECT_EQ(json["pass"], std::stoi(sample));
            expect_near(json["sum"], json["pixel_value"]);
            for (std::size_t c = 0; c < 3; ++c) {
                mean[c] += json["pixel_value"][c].get<double>() / 3;
            }
        }
        EXPECT_GT(mean[0], 0);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_FLOAT_EQ(static_cast<float>(mean[c]), image.rgb[3 * (9 * 16 + 7) + c]) << method;
        }
    }
}

TEST_F(ReplayTest, ShowsTheSamePathsForEveryNumberOfThreads) {
    const std::vector<std::string> vcm{run_of("store", "vcm"), "--store", file("store"), "--pixel",
                                       "8,7"};
    const auto with_threads = [&vcm](const char* n) {
        std::vector<std::string> arguments = vcm;
        arguments.insert(arguments.end(), {"--threads", n});
        return replay(arguments);
    };
    const auto one = with_threads("1");
    EXPECT_GE(one["samples"].size(), 1U);
    EXPECT_EQ(with_threads("5"), one);
}

TEST_F(ReplayTest, TellsTheWholeStoryOfEverySample) {
    const auto json =
        replay({"--scene", "CornellBox", "--method", "vcm", "--size", "16x12", "--pixel", "8,7",
                "--set", "merge_first=true", "--set", "radius_scale=2"});
    double last = 1e300;
    for (const auto& sample : json["samples"]) {
        const std::size_t n = sample["n_edges"];
        const auto& vertices = sample["vertices"];
        ASSERT_EQ(vertices.size(), n + 1);
        EXPECT_EQ(vertices[0]["kind"], "camera");
        for (std::size_t i = 1; i < n; ++i) {
            EXPECT_EQ(vertices[i]["kind"], "surface");
            EXPECT_NE(vertices[i]["material"], "");
            EXPECT_GT(vertices[i]["C"], 0);
            EXPECT_GT(vertices[i]["L"], 0);
        }
        EXPECT_EQ(vertices[n]["kind"], "light");
        EXPECT_EQ(vertices[n]["material"], "Light");
        EXPECT_EQ(sample["q"].size(), 2 * n);
        EXPECT_GT(sample["q"][sample["technique"].get<std::string>()], 0);
        EXPECT_GT(sample["p_nee"], 0);
        const bool merges = sample["technique"].get<std::string>().starts_with("merge");
        EXPECT_EQ(sample.contains("photon"), merges);
        double largest = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double weighted = sample["weighted_value"][c];
            EXPECT_DOUBLE_EQ(weighted,
                             sample["weight"].get<double>() * sample["value"][c].get<double>());
            largest = std::max(largest, weighted);
        }
        EXPECT_LE(largest, last) << "the largest come first";
        last = largest;
    }
    EXPECT_GE(json["samples"].size(), 2U);

    const Outcome text =
        misbench({"replay", "--scene", "CornellBox", "--method", "vcm", "--size", "16x12",
                  "--pixel", "8,7", "--set", "merge_first=true", "--set", "radius_scale=2"});
    EXPECT_THAT(
        text.out,
        AllOf(StartsWith("scene CornellBox, 16x12, method vcm, seed 1\n"),
              HasSubstr("\npixel 8,7 of pass 0: "), HasSubstr("\n  x0      camera\n"),
              HasSubstr("\n  x1      surface  "), HasSubstr("\n  photon "), HasSubstr("nee* "),
              HasSubstr("\nsum of weighted values  "), HasSubstr("\npixel of the pass       ")));
}

TEST_F(ReplayTest, NamesWhatAPathEndsOn) {
    const auto kinds = [](const std::string& scene, const std::string& pixel) {
        std::set<std::string> found;
        const auto json = replay({"--scene", scene, "--method", "bdpt", "--size", "16x12",
                                  "--pixel", pixel, "--set", "max_depth=3", "--sample", "1"});
        for (const auto& sample : json["samples"]) {
            for (const auto& vertex : sample["vertices"]) {
                found.insert(vertex["kind"].get<std::string>());
                EXPECT_EQ(vertex["kind"] == "infinite", vertex.contains("direction"));
            }
        }
        return found;
    };
    EXPECT_THAT(kinds("features/directional-light", "8,9"), testing::Contains("infinite"));
    EXPECT_THAT(kinds("features/point-light", "8,9"), testing::Contains("light"));
    EXPECT_THAT(kinds("features/conductor", "8,6"), testing::IsSupersetOf({"delta", "infinite"}));
}

TEST_F(ReplayTest, OptionsOfTheEstimateHaveTheirEffect) {
    const std::vector<std::string> base{"--scene", "CornellBox", "--method", "bdpt",
                                        "--size",  "16x12",      "--pixel",  "8,7"};
    const auto value = [&base](std::vector<std::string> more) {
        more.insert(more.begin(), base.begin(), base.end());
        return replay(more)["pixel_value"];
    };
    const auto plain = value({});
    EXPECT_EQ(value({"--seed", "1", "--sample", "0"}), plain);
    EXPECT_NE(value({"--seed", "2"}), plain);
    EXPECT_NE(value({"--sample", "1"}), plain);
    EXPECT_NE(value({"--set", "mis=maximum"}), plain);
}

TEST_F(ReplayTest, FindsARunByTheBeginningOfItsId) {
    const std::string run = run_of("store", "bdpt");
    const auto with = [](const std::string& beginning) {
        return std::vector<std::string>{"replay",      beginning, "--store",
                                        file("store"), "--pixel", "1,2"};
    };
    EXPECT_EQ(misbench(with(run.substr(0, 12))).out, misbench(with(run)).out);
    expect_refused(with(run.substr(0, 12) + "z"), "unknown run '" + run.substr(0, 12) + "z'");
    expect_refused(with(run.substr(0, 12) + "z"), "near: " + run);
    expect_refused(with(run + "0"), "near: " + run);

    // More runs than digits: two ids begin alike.
    std::map<char, int> n_of_beginning;
    for (const auto& [id, summary] :
         Store(file("store"), Store::Access::ReadOnly).run_summaries()) {
        ++n_of_beginning[id[0]];
    }
    const auto shared = std::ranges::find_if(n_of_beginning, [](auto n) { return n.second > 1; });
    expect_refused(with(std::string(1, shared->first)), "ambiguous run '");
}

TEST_F(ReplayTest, GoesToTheFirstBadSampleByItself) {
    const std::string run = run_of("bright", "bdpt");
    const Record record = Store(file("bright"), Store::Access::ReadOnly).run(run).value();
    ASSERT_TRUE(record.statistics.first_bad_sample.has_value());
    const SamplePlace bad = *record.statistics.first_bad_sample;
    const auto json = replay({run, "--store", file("bright")});
    EXPECT_EQ(json["pixel"], nlohmann::json({bad.x, bad.y}));
    EXPECT_EQ(json["pass"], bad.pass);
    EXPECT_THAT(json["samples"][0]["weighted_value"].dump(), HasSubstr("inf"))
        << "what is not finite comes first";
    EXPECT_EQ(json["sum"], json["pixel_value"]);
    expect_refused({"replay", run_of("store", "bdpt"), "--store", file("store")},
                   "has no bad sample");
}

TEST_F(ReplayTest, RefusesWhatIsNotInTheRun) {
    const auto with = [](const std::string& method, std::vector<std::string> more) {
        more.insert(more.begin(), {"replay", run_of("store", method), "--store", file("store")});
        return more;
    };
    expect_refused(with("bdpt", {"--pixel", "16,0"}), "x must be a decimal integer from 0 to 15");
    expect_refused(with("bdpt", {"--pixel", "0,-1"}), "y must be a decimal integer from 0 to 11");
    expect_refused(with("bdpt", {"--pixel", "3"}), "--pixel 3: must be x,y");
    expect_refused(with("bdpt", {"--pixel", "0,0", "--sample", "3"}),
                   "has 3 samples a pixel, counted from 0");
    expect_refused(with("bdpt", {"--pixel", "0,0", "--seed", "3"}), "excludes");
    expect_refused(with("path", {"--pixel", "0,0"}), "method 'path' does not show its samples");
    expect_refused({"replay", "--pixel", "0,0"}, "give a run and its --store, or --scene");
    expect_refused({"replay", "ab", "--pixel", "0,0"}, "--store");
    expect_refused({"replay", "ab", "--store", file("nowhere"), "--pixel", "0,0"}, "nowhere");
}

TEST_F(ReplayTest, RefusesASceneThatIsNotTheRunsButFindsItElsewhere) {
    const std::vector<std::string> arguments{
        "replay", run_of("store", "bdpt"), "--store", file("store"), "--pixel", "8,9"};
    const std::string before = misbench(arguments).out;
    const auto elsewhere = [&arguments](const std::string& scene) {
        std::vector<std::string> more = arguments;
        more.insert(more.end(), {"--scene", scene});
        return more;
    };
    fs::rename(file("store-scenes/Box.json"), file("Moved.json"));
    expect_refused(arguments, "Box.json");
    EXPECT_EQ(misbench(elsewhere(file("Moved.json"))).out, before);
    folder_->write("store-scenes/Box.json", box(true));
    expect_refused(arguments, "it changed since the run; its hash is ");
    expect_refused(elsewhere(file("bright-scenes/Box.json")), "it changed since the run");
    fs::rename(file("Moved.json"), file("store-scenes/Box.json"));
    EXPECT_EQ(misbench(arguments).out, before);
}

// --- render --techniques -------------------------------------------------------------------------

TEST_F(ReplayTest, TheWeightedTechniquesAddUpToTheImage) {
    for (const char* scene :
         {"CornellBox", "VeachBidir", "VeachMIS", "TextureTest", "features/envmap",
          "features/directional-light", "features/point-light", "features/spot-light",
          "features/thinlens", "features/sphere-light", "features/dielectric", "features/mask"}) {
        for (const char* method : {"bdpt", "light", "photon", "vcm"}) {
            const Outcome outcome = misbench(
                {"render", scene, "--method", method, "--spp", "3", "--size", "16x12", "--set",
                 "max_depth=5", "-o", file("image.exr"), "--techniques", file("layers.exr")});
            const std::string what = std::string(scene) + " by " + method;
            ASSERT_EQ(outcome.exit_code, 0) << what << outcome.err;
            const Image image = read_exr(file("image.exr"));
            std::map<std::string, Image> layers = test::exr_layers(file("layers.exr"));
            EXPECT_EQ(layers.at(""), image);
            std::vector<double> sum(image.rgb.size());
            for (const auto& [name, layer] : layers) {
                if (!name.starts_with("weighted.")) continue;
                EXPECT_TRUE(layers.contains("un" + name));
                for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += double{layer.rgb[i]};
            }
            for (std::size_t i = 0; i < sum.size(); ++i) {
                const double expected = double{image.rgb[i]};
                ASSERT_NEAR(sum[i], expected, 1e-5 * expected + 1e-12) << what << " value " << i;
            }
        }
    }
}

TEST_F(ReplayTest, TechniquesAreOnePictureAndATableOfTheirParts) {
    const auto render = [](const std::string& exposure, const std::string& threads) {
        return misbench({"render", "CornellBox", "--method", "bdpt", "--set", "max_depth=3",
                         "--spp", "2", "--size", "16x12", "-o", file("image.png"), "--techniques",
                         file("pyramid.png"), "--exposure", exposure, "--threads", threads});
    };
    const Outcome outcome = render("0", "1");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("% of image  hit "));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\nn = 2 +[0-9.]+ +[0-9.]+ +[0-9.]+ +-\n"));
    EXPECT_THAT(outcome.out, HasSubstr("connect1\n"));
    const std::string png = slurp(file("pyramid.png"));
    // Four columns and twice three rows, with gaps of two pixels.
    EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x46\0\0\0\x56", 8));
    EXPECT_EQ(render("0", "5").out, outcome.out);
    EXPECT_EQ(slurp(file("pyramid.png")), png);
    render("3", "1");
    EXPECT_NE(slurp(file("pyramid.png")), png);
}

TEST_F(ReplayTest, TechniquesAreOfEqualSamplesAndOfMethodsThatShowThem) {
    const std::vector<std::string> base{"render", "CornellBox",  "--size",       "16x12",
                                        "-o",     file("a.exr"), "--techniques", file("t.exr")};
    const auto with = [&base](std::vector<std::string> more) {
        more.insert(more.begin(), base.begin(), base.end());
        return more;
    };
    expect_refused(with({"--method", "bdpt", "--seconds", "1"}), "--techniques requires --spp");
    expect_refused(with({"--method", "path", "--set", "bsdf=false", "--spp", "1"}),
                   "method 'path' does not show its samples");
    expect_refused(
        {"render", "CornellBox", "--spp", "1", "-o", file("a.exr"), "--techniques", file("t.jpg")},
        "unknown extension; known: .exr .png");
    EXPECT_FALSE(fs::exists(file("a.exr")));
}

// --- render --factors ----------------------------------------------------------------------------

TEST_F(ReplayTest, LearnedFactorsAreImages) {
    const Outcome outcome = misbench({"render", "CornellBox", "--method", "vcm", "--set",
                                      "factors=correction", "--spp", "2", "--size", "16x12", "-o",
                                      file("image.exr"), "--factors", file("factors.exr")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("factor            mean "));
    const std::map<std::string, Image> layers = test::exr_layers(file("factors.exr"));
    for (const char* name : {"correction.merge", "correction.light"}) {
        ASSERT_TRUE(layers.contains(name)) << name;
        const Image& map = layers.at(name);
        EXPECT_EQ(map.n_pixels(), 16U * 12U);
        EXPECT_THAT(map.rgb, testing::Each(testing::AllOf(testing::Gt(0.0F), testing::Le(1.0F))));
    }
    expect_refused({"render", "CornellBox", "--spp", "1", "--size", "16x12", "-o", file("b.exr"),
                    "--factors", file("none.exr")},
                   "the method learned no factors");
    expect_refused(
        {"render", "CornellBox", "--spp", "1", "-o", file("b.exr"), "--factors", file("f.png")},
        "unknown extension; known: .exr");
}

TEST_F(ReplayTest, APassAfterTheTrainingHasTheFactorsThatWereLearned) {
    const std::vector<std::string> base{
        "replay", "--scene", "CornellBox", "--method", "vcm",    "--set",   "factors=correction",
        "--size", "16x12",   "--pixel",    "8,7",      "--json", "--sample"};
    const auto factors_of = [&base](const std::string& pass) {
        std::vector<std::string> all = base;
        all.push_back(pass);
        std::vector<double> factors;
        const auto json = nlohmann::json::parse(misbench(all).out);
        for (const auto& sample : json.at("samples")) {
            for (const auto& [technique, factor] : sample.at("factors").items()) {
                factors.push_back(factor.get<double>());
            }
        }
        const auto sum = json.at("sum").get<std::vector<double>>();
        const auto value = json.at("pixel_value").get<std::vector<double>>();
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], value[c], 1e-5 * value[c]);
        return factors;
    };
    EXPECT_THAT(factors_of("0"), testing::Each(1));
    EXPECT_THAT(factors_of("1"), testing::Contains(testing::Lt(1)));
}

}  // namespace
}  // namespace misbench
