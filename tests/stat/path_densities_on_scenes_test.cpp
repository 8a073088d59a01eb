// Every sample of the bidirectional methods, on all scenes there are: its densities against those
// that follow from the path's vertices alone, its value against what the path contributes, and its
// weight among those of all techniques.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "renderer/methods/render_loop.h"
#include "renderer/paths/path_weights.h"
#include "renderer/scene/load.h"
#include "tests/support/gallery.h"
#include "tests/support/path_oracle.h"
#include "tests/support/technique_table.h"

namespace misbench {
namespace {

constexpr int kWidth = 16;
constexpr int kHeight = 12;

// Relative, beside what the directions of a path's edges are known to be wrong by: positions and
// directions are float, and a lobe of alpha 1e-3 makes 1e-3 of the 1e-6 in a direction.
constexpr double kTolerance = 1e-3;
// Where the cosine of an edge is known no better than this, nothing is compared.
constexpr double kEdgeOn = 0.1;

std::string to_string(Technique t) {
    constexpr std::array kNames = {"hit", "nee", "light", "connect", "merge"};
    return kNames[static_cast<std::size_t>(t.kind)] + (" " + std::to_string(t.k));
}

struct Settings {
    std::string name;
    std::string method;
    ParameterMap parameters;
    TechniqueCounts counts;  // without connect
    std::string light_selection = "power";
};

// Numbers from two sides, and how much they differ.
class Differences {
 public:
    void add(double a, double b, double tolerance, const std::function<std::string()>& describe) {
        const double largest = std::max(std::abs(a), std::abs(b));
        const double difference = largest > 0 ? std::abs(a - b) / largest : 0;
        ++n_;
        if (!(difference <= tolerance)) ++n_apart_;
        if (!(difference <= worst_)) {
            worst_ = difference;
            worst_text_ = describe();
        }
    }
    // A few may be further apart, where a density itself changes as fast as rounding moves it.
    void expect_equal(const char* what, double part_apart, double limit) const {
        EXPECT_LE(n_apart_, part_apart * static_cast<double>(n_))
            << "of " << n_ << " " << what << ", the furthest apart: " << worst_text_;
        EXPECT_LE(worst_, limit) << what << ": " << worst_text_;
    }

 private:
    std::size_t n_ = 0;
    std::size_t n_apart_ = 0;
    double worst_ = -1;
    std::string worst_text_;
};

class Audit final : public SampleObserver {
 public:
    Audit(const Scene& scene, const Settings& settings, const TechniqueCounts& counts)
        : counts_(counts),
          oracle_(scene, kWidth, kHeight, settings.light_selection),
          has_lens_(scene.camera().lens_radius > 0) {
        for (const MisHeuristic& row : heuristics()) {
            weights_.emplace_back(Heuristic::parse(std::string(row.name)));
        }
    }

    bool wants_zeros() const override { return true; }

    void observe(const Sample& sample, std::size_t /*chunk*/) override {
        if (testing::Test::HasFatalFailure()) return;
        const int n = sample.path.n_edges();
        ++n_of_kind_[sample.technique.kind];
        check_weights(sample);
        // Where on the lens a light path was connected to, the path does not say.
        if (has_lens_ && sample.technique.kind == TechniqueKind::Light) return;
        // Of long paths some are enough.
        if (++n_of_shape_[{sample.technique.kind, sample.technique.k, n}] > 400) return;
        const test::PathOracle::Answer answer = oracle_.ask(sample.path);
        ++n_asked_;
        if (answer.misses_delta_lobe) {
            ++n_without_lobe_;
            return;
        }
        direction_error_ = std::max(direction_error_, answer.direction_error);
        tolerance_ = kTolerance + 4 * answer.rounding;
        if (tolerance_ > kEdgeOn) {
            if (!(sample.value == Rgb{})) ++n_edge_on_;
            return;
        }
        if (n > 1) {
            check_densities(sample, answer.densities);
            if (counts_.merge > 0) {
                compare(sample, "merge area", 1, sample.path.densities->merge_area,
                        M_PI * answer.pixel_area);
            }
        }
        check_value(sample, answer);
    }

    void expect_agreement() const {
        densities_.expect_equal("densities", 5e-4, 0.03);
        values_.expect_equal("values", 0, 0.01);
        sides_.expect_equal("contributions from both sides", 5e-4, 0.01);
        EXPECT_LT(direction_error_, 1e-4);
        EXPECT_EQ(n_without_lobe_, 0) << "delta vertices without a delta lobe in that direction";
        // What is left out connects points of one wall, or nearly, and carries no light.
        EXPECT_LT(n_edge_on_, 0.01 * static_cast<double>(n_asked_));
    }

    // How often each kind of technique made a sample.
    const std::map<TechniqueKind, std::size_t>& counts_by_kind() const { return n_of_kind_; }

 private:
    struct Where {
        const char* what = "";
        int i = 0;
        double found = 0;
        double expected = 0;
    };
    std::string describe(const Sample& sample, int i, const Where& where) const {
        std::ostringstream out;
        const PathView& path = sample.path;
        out << to_string(sample.technique) << " of " << path.n_edges() << " edges, pixel "
            << path.pixel.x << " " << path.pixel.y << ": " << where.what << "_" << i << " is "
            << where.found << ", expected " << where.expected << "; vertices";
        for (int v = 1; v <= path.n_edges(); ++v) {
            const PathVertex& vertex = path.vertex(v);
            const Vec3 p = vertex.point.position;
            out << " (" << p.x << " " << p.y << " " << p.z << (vertex.is_delta ? " delta" : "")
                << (vertex.point.material ? " " + vertex.point.material->name : "") << " wo "
                << vertex.wo.x << " " << vertex.wo.y << " " << vertex.wo.z << ")";
        }
        return out.str();
    }

    void check_weights(const Sample& sample) {
        const int n = sample.path.n_edges();
        for (const PathWeights& weights : weights_) {
            double sum = 0;
            bool any = false;
            for (int t = 0; t < n_techniques(n); ++t) {
                const auto weight =
                    weights.weigh(sample.path, counts_, technique_at(t, n), scratch_);
                sum += weight.w;
                any = any || weight.q[static_cast<std::size_t>(t)] > 0;
            }
            if (any) {
                ASSERT_NEAR(sum, 1, 1e-10) << describe(sample, 0, {});
            }
        }
        // The first is the one that the method uses.
        const auto own = weights_[0].weigh(sample.path, counts_, sample.technique, scratch_);
        ASSERT_NEAR(own.w, sample.weight, 1e-9) << describe(sample, 0, {});
        ASSERT_EQ(own.q.size(), sample.q.size());
        for (std::size_t t = 0; t < own.q.size(); ++t) {
            ASSERT_NEAR(own.q[t], sample.q[t], 1e-9 * own.q[t]) << t << describe(sample, 0, {});
        }
    }

    void compare(const Sample& sample, const char* what, int i, double found, double expected) {
        densities_.add(found, expected, tolerance_, [&] {
            return describe(sample, i, {what, i, found, expected});
        });
    }

    void check_densities(const Sample& sample, const PathDensities& expected) {
        const PathDensities& found = *sample.path.densities;
        const int n = expected.n_edges;
        // The density of a photon that is merged is that of its own place, where the surface may be
        // turned otherwise.
        const bool merged = sample.technique.kind == TechniqueKind::Merge;
        const int k = sample.technique.k;
        const bool same_plane = !merged || sample.path.light.back().point.normal ==
                                               sample.path.camera.back().point.normal;
        for (int i = 1; i <= n; ++i) {
            const auto at = static_cast<std::size_t>(i);
            compare(sample, "C", i, found.from_camera[at], expected.from_camera[at]);
            if (i != k || same_plane) {
                compare(sample, "L", i, found.from_light[at], expected.from_light[at]);
            }
            if (i < n) {
                ASSERT_EQ(found.is_delta[at], expected.is_delta[at]) << describe(sample, i, {});
            }
        }
        compare(sample, "p_nee", n, found.next_event, expected.next_event);
    }

    void check_value(const Sample& sample, const test::PathOracle::Answer& answer) {
        test::WeighedPath path{answer.densities, counts_};
        path.densities.merge_area = M_PI * answer.pixel_area;
        double q = 1;
        if (path.n() > 1) {
            const test::LongProduct product = test::by_the_table(path, sample.technique);
            q = std::ldexp(static_cast<double>(product.significand),
                           static_cast<int>(product.exponent));
        } else {
            q = path.camera(1);
        }
        const std::array value = {double{sample.value.r}, double{sample.value.g},
                                  double{sample.value.b}};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto at = static_cast<int>(c);
            const double a = answer.from_camera[c];
            const double b = answer.from_light[c];
            sides_.add(a, b, tolerance_, [&] { return describe(sample, at, {"f", at, b, a}); });
            // Blocked, or with a direction that carries nothing.
            if (sample.value == Rgb{}) continue;
            values_.add(value[c], a / q, tolerance_, [&] {
                return describe(sample, at, {"value", at, value[c], a / q});
            });
        }
    }

    struct Shape {
        TechniqueKind kind;
        int k;
        int n;
        auto operator<=>(const Shape&) const = default;
    };

    TechniqueCounts counts_;
    test::PathOracle oracle_;
    bool has_lens_;
    std::vector<PathWeights> weights_;
    PathWeights::Scratch scratch_;
    std::map<TechniqueKind, std::size_t> n_of_kind_;
    std::map<Shape, int> n_of_shape_;
    std::size_t n_asked_ = 0;
    std::size_t n_without_lobe_ = 0;
    double direction_error_ = 0;
    std::size_t n_edge_on_ = 0;
    double tolerance_ = 0;
    Differences densities_, values_, sides_;
};

std::vector<Settings> all_settings() {
    const double n = kWidth * kHeight;
    const std::int64_t depth = 6;
    const std::int64_t off = 0;
    return {{.name = "bdpt",
             .method = "bdpt",
             .parameters = {{"max_depth", depth}, {"rr_depth", off}, {"pairing", "path"}},
             .counts = {.light = n, .connect = 1}},
            {.name = "bdpt with the light tree",
             .method = "bdpt",
             .parameters = {{"max_depth", depth},
                            {"rr_depth", off},
                            {"pairing", "path"},
                            {"light_selection", "tree"}},
             .counts = {.light = n, .connect = 1},
             .light_selection = "tree"},
            {.name = "vcm",
             .method = "vcm",
             .parameters = {{"max_depth", depth},
                            {"rr_depth", off},
                            {"connections", 2.0},
                            {"light_paths", 0.5},
                            {"shadow_rays", std::int64_t{2}},
                            {"bsdf_samples", std::int64_t{2}},
                            {"merge_first", true},
                            {"kernel", "constant"},
                            {"light_selection", "uniform"}},
             .counts = {.nee = 2,
                        .light = n / 2,
                        .connect = 0,
                        .merge = n / 2,
                        .split = 2,
                        .merge_first = true},
             .light_selection = "uniform"}};
}

std::map<TechniqueKind, std::size_t> audit(const std::string& name, const Scene& scene,
                                           const Settings& settings) {
    SCOPED_TRACE(name + " by " + settings.name);
    RenderRequest request{.method = settings.method,
                          .parameters = settings.parameters,
                          .width = kWidth,
                          .height = kHeight,
                          .budget = SampleBudget{1}};
    TechniqueCounts counts = settings.counts;
    if (counts.connect == 0) {
        // Which part of the cache a connection draws is known after the pass.
        const auto description = nlohmann::json::parse(render(scene, request).description);
        const double n_cached = description.at("light_vertices");
        if (n_cached > 0) counts.connect = 2.0 * counts.light / n_cached;
    }
    Audit observer(scene, settings, counts);
    request.observer = &observer;
    const RenderResult result = render(scene, request);
    EXPECT_TRUE(result.valid);
    observer.expect_agreement();
    return observer.counts_by_kind();
}

TEST(PathDensities, AreThoseOfTheVerticesInEveryScene) {
    const std::vector<SceneListing> scenes = list_scenes(MISBENCH_SCENES);
    EXPECT_GT(scenes.size(), 40);
    for (const SceneListing& listing : scenes) {
        const LoadedScene loaded = load_scene(listing.file, 2);
        for (const Settings& settings : all_settings()) {
            audit(listing.name, *loaded.scene, settings);
            if (HasFatalFailure()) return;
        }
    }
}

TEST(PathDensities, AreThoseOfTheVerticesInTheGallery) {
    using namespace test;
    std::map<TechniqueKind, std::size_t> n_of_kind;
    const auto check = [&](const std::string& name, const SceneDescription& description) {
        const Scene scene(description, 1);
        for (const Settings& settings : all_settings()) {
            for (const auto& [kind, n] : audit(name, scene, settings)) n_of_kind[kind] += n;
        }
    };
    check("surfaces", lit_by_surfaces(gallery()));
    check("points", lit_by_points(gallery()));
    check("far", lit_from_far(gallery()));
    const SceneDescription all = lit_from_far(lit_by_points(lit_by_surfaces(gallery())));
    check("all", all);
    check("lens", through_a_lens(all));
    for (const auto kind : {TechniqueKind::Hit, TechniqueKind::NextEvent, TechniqueKind::Light,
                            TechniqueKind::Connect, TechniqueKind::Merge}) {
        EXPECT_GT(n_of_kind[kind], 500) << to_string({kind, 0});
    }
}

}  // namespace
}  // namespace misbench
