#include "renderer/methods/render_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/disturbance.h"
#include "renderer/methods/parameters_of.h"
#include "renderer/methods/pass_context.h"
#include "renderer/scene/load.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Scene& box() {
    static const Scene scene(test::furnace(DiffuseMaterial{{0.5F, 0.5F, 0.5F}}, {1, 1, 1}), 1);
    return scene;
}

struct NoParameters {
    static void fields(auto& /*self*/, auto&& /*field*/) {}
    void check() {}
};

// The pass function of a test's own method; the parameters are not used.
std::function<void(PassContext&)> g_pass;
std::function<Forgotten(int)> g_finish;

class ScriptedMethod final : public Method {
 public:
    explicit ScriptedMethod(NoParameters /*unused*/) {}
    void start(const Scene& /*scene*/, FrameInfo /*frame*/) override {}
    void pass(PassContext& context) override { g_pass(context); }
    Forgotten finish_pass(ThreadPool& /*threads*/) override {
        return g_finish ? g_finish(n_++) : Forgotten{};
    }
    void describe(nlohmann::json& json) const override { json["passes"] = n_; }

 private:
    int n_ = 0;
};

RenderResult run_script(const Budget& budget, bool may_be_negative = false,
                        std::function<bool()> abandon = {}) {
    const MethodInfo info = method_info_of<ScriptedMethod, NoParameters>(
        "script", "", 1, may_be_negative, [](const SceneFeatures&) { return std::string(); });
    return render(box(), info,
                  {.method = "script",
                   .parameters = {},
                   .width = 40,
                   .height = 20,
                   .budget = budget,
                   .threads = 2,
                   .abandon = std::move(abandon)});
}

class RenderLoop : public testing::Test {
 protected:
    void SetUp() override {
        g_finish = nullptr;
        value_at({1, 1, 1});
    }
    // Every sample has this value.
    static void value_at(Rgb value) {
        g_pass = [value](PassContext& context) {
            context.for_each_pixel(
                [value](const CameraSample&, Rng&, RayTracer&) { return value; });
        };
    }
};

RenderResult render_cornell(const std::string& method, int threads) {
    static const LoadedScene loaded =
        load_scene(std::string(MISBENCH_SCENES) + "/CornellBox/CornellBox.json", 1);
    return render(*loaded.scene, {.method = method,
                                  .parameters = {},
                                  .width = 61,
                                  .height = 47,
                                  .budget = SampleBudget{3},
                                  .seed = 5,
                                  .threads = threads});
}

TEST_F(RenderLoop, GivesTheSameBitsForOneTwoAndSevenThreads) {
    for (const MethodInfo& method : methods()) {
        const std::string name(method.name);
        const RenderResult one = render_cornell(name, 1);
        for (const int threads : {2, 7}) {
            const RenderResult many = render_cornell(name, threads);
            EXPECT_EQ(one.image, many.image) << name << " on " << threads;
            EXPECT_EQ(one.statistics.rays, many.statistics.rays);
        }
    }
}

TEST_F(RenderLoop, GivesOtherImagesForOtherSeeds) {
    const auto render_seed = [](std::int64_t seed) {
        return render(box(), {.method = "path",
                              .parameters = {},
                              .width = 8,
                              .height = 8,
                              .budget = SampleBudget{1},
                              .seed = seed})
            .image;
    };
    EXPECT_EQ(render_seed(1), render_seed(1));
    EXPECT_NE(render_seed(1), render_seed(2));
    EXPECT_NE(render_seed(1), render_seed((std::int64_t{1} << 32) + 1));
}

TEST_F(RenderLoop, RendersAsManyPassesAsSamplesAreAsked) {
    const RenderResult result = run_script(SampleBudget{7});
    EXPECT_EQ(result.statistics.passes, 7);
    EXPECT_TRUE(result.valid);
    EXPECT_EQ(result.image.rgb[0], 1);
}

TEST_F(RenderLoop, CountsOnlyPassesThatWereCompleteWithinTheTime) {
    // Each pass takes 30 ms of wall time at least, in its first chunk.
    g_pass = [](PassContext& context) {
        std::atomic<bool> slept = false;
        context.for_each_pixel([&](const CameraSample&, Rng&, RayTracer&) {
            if (!slept.exchange(true)) std::this_thread::sleep_for(std::chrono::milliseconds(30));
            return Rgb{1, 1, 1};
        });
    };
    const RenderResult result = run_script(TimeBudget{0.2, BudgetClock::Wall});
    EXPECT_GE(result.statistics.passes, 1);
    EXPECT_LE(result.statistics.passes, 6);
    EXPECT_LE(result.statistics.wall_seconds, 0.2);
    EXPECT_GE(result.statistics.wall_seconds, 0.03 * double(result.statistics.passes));
    EXPECT_GT(result.statistics.discarded_wall_seconds, 0);
    EXPECT_EQ(result.image.rgb[0], 1) << "the discarded pass is not in the mean";
}

TEST_F(RenderLoop, CallsARunWithoutACompletePassInvalid) {
    const RenderResult result = run_script(TimeBudget{0, BudgetClock::Wall});
    EXPECT_EQ(result.statistics.passes, 0);
    EXPECT_FALSE(result.valid);
}

TEST_F(RenderLoop, KeepsToACpuBudget) {
    g_pass = [](PassContext& context) {
        context.for_each_pixel([](const CameraSample&, Rng& rng, RayTracer&) {
            float sum = 0;
            for (int i = 0; i < 1000; ++i) sum += rng.uniform();
            return Rgb{sum, sum, sum};
        });
    };
    const RenderResult result = run_script(TimeBudget{0.1, BudgetClock::Cpu});
    EXPECT_GE(result.statistics.passes, 1);
    EXPECT_LE(result.statistics.cpu_seconds, 0.1);
    EXPECT_GE(result.statistics.cpu_seconds + result.statistics.discarded_cpu_seconds, 0.1);
}

TEST_F(RenderLoop, CountsNonFiniteSamplesAndSaysWhereTheFirstWas) {
    std::atomic<int> pass = 0;
    g_pass = [&pass](PassContext& context) {
        const bool bad = pass++ == 2;
        context.for_each_pixel([bad](const CameraSample& sample, Rng&, RayTracer&) {
            const bool right_half = sample.ray.direction.x > 0;
            return bad && right_half ? Rgb{std::nanf(""), 0, 0} : Rgb{1, 1, 1};
        });
    };
    const RenderResult result = run_script(SampleBudget{4});
    EXPECT_FALSE(result.valid);
    EXPECT_EQ(result.statistics.nonfinite_samples, 20 * 20);
    EXPECT_EQ(result.statistics.first_bad_sample, (SamplePlace{.x = 20, .y = 0, .pass = 2}));
    EXPECT_TRUE(std::isnan(result.image.rgb[3 * 20])) << "shown, never masked";
}

TEST_F(RenderLoop, CallsNegativeSamplesInvalidUnlessTheMethodDeclaresThem) {
    value_at({1, -0.5F, 1});
    EXPECT_FALSE(run_script(SampleBudget{1}).valid);
    EXPECT_TRUE(run_script(SampleBudget{1}, /*may_be_negative=*/true).valid);
    EXPECT_EQ(run_script(SampleBudget{1}).statistics.negative_samples, 800);
}

TEST_F(RenderLoop, DropsTheFrameWhenTheMethodSaysSoAndNeverReusesItsNumbers) {
    std::vector<float> firsts;
    g_pass = [&firsts](PassContext& context) {
        std::atomic<float> first = 0;
        context.for_each_pixel([&first](const CameraSample&, Rng& rng, RayTracer&) {
            const float u = rng.uniform();
            if (first == 0) first = u;
            return Rgb{1, 1, 1};
        });
        firsts.push_back(first);
    };
    g_finish = [](int n) { return Forgotten{.all = n == 1}; };
    const RenderResult result = run_script(SampleBudget{5});
    EXPECT_EQ(result.statistics.passes, 3) << "two of the five were dropped";
    EXPECT_EQ(result.image.rgb[0], 1);
    std::sort(firsts.begin(), firsts.end());
    EXPECT_EQ(std::unique(firsts.begin(), firsts.end()), firsts.end());
    EXPECT_THAT(result.description, HasSubstr("\"passes\":5"));
}

TEST_F(RenderLoop, CountsThePeakOfMemoryOfThisRenderAlone) {
    constexpr std::size_t kBytes = 256U << 20U;
    void* before =
        ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(before, MAP_FAILED);
    std::memset(before, 1, kBytes);
    const std::int64_t peak = read_disturbance().peak_memory_bytes;
    ASSERT_EQ(::munmap(before, kBytes), 0);
    const RenderResult result = run_script(SampleBudget{1});
    EXPECT_GT(result.statistics.peak_memory_bytes, 0);
    EXPECT_LT(result.statistics.peak_memory_bytes, peak - static_cast<std::int64_t>(kBytes / 2));
}

TEST_F(RenderLoop, StopsWhenAskedTo) {
    std::atomic<int> n_asked = 0;
    const RenderResult result =
        run_script(SampleBudget{1'000'000'000}, false, [&] { return ++n_asked > 50; });
    EXPECT_TRUE(result.abandoned);
}

TEST_F(RenderLoop, PassesOnAnErrorOfAMethod) {
    g_pass = [](PassContext& context) {
        context.for_each_pixel([](const CameraSample&, Rng&, RayTracer&) -> Rgb {
            throw Error(Errc::Internal, "broken method");
        });
    };
    EXPECT_THAT([] { run_script(SampleBudget{1}); },
                ThrowsMessage<Error>(HasSubstr("broken method")));
}

TEST_F(RenderLoop, RefusesAnEmptyImage) {
    EXPECT_THROW(render(box(), {.method = "path", .parameters = {}, .width = 0, .height = 4}),
                 Error);
}

class EveryMethod : public testing::TestWithParam<std::string> {
 protected:
    const MethodInfo& info_ = find_method(GetParam());
};

TEST_P(EveryMethod, RoundTripsItsEffectiveParameters) {
    const ParameterMap defaults = info_.effective({});
    EXPECT_EQ(info_.effective(defaults), defaults);
    EXPECT_EQ(info_.parameters().size(), defaults.size());
    for (const ParameterInfo& parameter : info_.parameters()) {
        EXPECT_EQ(defaults.at(parameter.name), parameter.default_value) << parameter.name;
        EXPECT_FALSE(parameter.help.empty());
    }
}

TEST_P(EveryMethod, RendersAnOpenSceneInTheGeneralLoopAsInThePlainOne) {
    const auto image = [](const SceneFeatures& assumed) {
        SceneDescription description = test::floor_under_lamp({0.5F, 0.5F, 0.5F}, {1, 1, 1});
        description.camera.fov_degrees = 60;
        return render(Scene(std::move(description), 1, assumed), {.method = GetParam(),
                                                                  .parameters = {},
                                                                  .width = 16,
                                                                  .height = 16,
                                                                  .budget = SampleBudget{4},
                                                                  .seed = 1,
                                                                  .threads = 1})
            .image;
    };
    EXPECT_EQ(image({}), image({.quadrics = true}));
}

TEST_P(EveryMethod, RefusesAParameterItDoesNotKnow) {
    EXPECT_THAT(
        [this] {
            info_.effective({{"no_such", true}});
        },
        ThrowsMessage<ParameterError>(HasSubstr("unknown parameter 'no_such'; known: ")));
}

TEST_P(EveryMethod, RefusesAParameterOfAnotherType) {
    for (const ParameterInfo& parameter : info_.parameters()) {
        const bool is_text = std::holds_alternative<std::string>(parameter.default_value);
        const ParameterValue wrong =
            is_text ? ParameterValue(true) : ParameterValue(std::string("text"));
        try {
            info_.effective({{parameter.name, wrong}});
            FAIL() << parameter.name;
        } catch (const ParameterError& e) {
            EXPECT_EQ(e.key(), parameter.name);
        }
    }
}

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const MethodInfo& method : methods()) names.emplace_back(method.name);
    return names;
}
INSTANTIATE_TEST_SUITE_P(Catalogue, EveryMethod, testing::ValuesIn(method_names()),
                         [](const auto& test) { return test.param; });

TEST(Path, RefusesParametersThatCannotBe) {
    const MethodInfo& path = find_method("path");
    EXPECT_THROW(path.effective({{"max_depth", std::int64_t{0}}}), ParameterError);
    EXPECT_THROW(path.effective({{"mis", std::string("ballance")}}), ParameterError);
    EXPECT_THROW(path.effective({{"nee", false}, {"bsdf", false}}), ParameterError);
    EXPECT_THROW(path.effective({{"light_selection", std::string("dark")}}), ParameterError);
    EXPECT_EQ(path.effective({{"mis", std::string("power")}}).at("mis"),
              ParameterValue(std::string("power2")));
}

TEST(Catalogue, NamesWhatItKnows) {
    EXPECT_THAT([] { find_method("paht"); },
                ThrowsMessage<Error>(HasSubstr("unknown method 'paht'; known: path direct")));
}

// The loop for plain scenes leaves out what they lack, and nothing else.
TEST(Specialization, GivesAPlainSceneTheBitsOfTheGeneralLoop) {
    for (const char* file : {"Box/LightCenter.json", "VeachMIS/VeachMIS.json"}) {
        const std::string path = std::string(MISBENCH_SCENES) + "/" + file;
        const LoadedScene plain = load_scene(path, 1);
        const LoadedScene general = load_scene(path, 1, kAllFeatures);
        EXPECT_EQ(plain.scene->features(), SceneFeatures{}) << file;
        for (const MethodInfo& method : methods()) {
            const RenderRequest request{.method = std::string(method.name),
                                        .parameters = {},
                                        .width = 40,
                                        .height = 30,
                                        .budget = SampleBudget{4},
                                        .seed = 3,
                                        .threads = 1};
            EXPECT_EQ(render(*plain.scene, request).image, render(*general.scene, request).image)
                << file << ' ' << method.name;
        }
    }
}

}  // namespace
}  // namespace misbench
