// The weights of full paths: against the recursive quantities by which vertex connection and
// merging is usually weighed, and that those of all techniques make one whole, whatever factors
// there are.
//
// [GKDS12]  I. Georgiev, J. Křivánek, T. Davidovič, P. Slusallek, Light transport simulation with
//           vertex connection and merging, 2012, and the technical report on its implementation.
#include "renderer/paths/path_weights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/random_paths.h"

namespace misbench {
namespace {

using test::is_possible;
using test::RandomPaths;
using Path = test::WeighedPath;

// The balance heuristic as [GKDS12] computes it on the way, from three numbers a vertex of either
// subpath. In their terms, for vertex i of a subpath, p→ the area density by which the subpath
// found it, p← = g← · pσ← the one from the other side as solid angle density times conversion, and
// η the number of merges over the connections' that an area density of one stands for:
//   dVCM_i = 1 / p→_i
//   dVC_i  = g←_{i-1} / p→_i (η + dVCM_{i-1} + pσ←_{i-2} dVC_{i-1})
//   dVM_i  = g←_{i-1} / p→_i (1 + dVCM_{i-1} / η + pσ←_{i-2} dVM_{i-1})
// The sums of all techniques that have fewer vertices of this subpath are, over the connection at
// vertex i,  p←_i (η + dVCM_i + pσ←_{i-1} dVC_i)  and over the merge,  dVCM_i / η + pσ←_{i-1}
// dVM_i.
class RecursiveWeights {
 public:
    RecursiveWeights(const Path& path, const std::vector<double>& camera_g,
                     const std::vector<double>& light_g)
        : path_(path),
          eta_(path.counts.merge * path.densities.merge_area / path.counts.connect),
          camera_g_(camera_g),
          light_g_(light_g),
          camera_(static_cast<std::size_t>(path.n()) + 1),
          light_(camera_.size()) {
        walk_from_camera();
        walk_from_light();
    }

    double weight(Technique t) const {
        const int n = path_.n();
        const TechniqueCounts& counts = path_.counts;
        const double nee = counts.nee * path_.densities.next_event;
        switch (t.kind) {
            case TechniqueKind::Hit: {
                const D& d = camera_[static_cast<std::size_t>(n)];
                const double emission = path_.light(n) * light_sigma(n - 1);
                return 1 / (1 + (nee * d.vcm + counts.connect * emission * d.vc) / counts.hit);
            }
            case TechniqueKind::NextEvent: {
                const double connected =
                    counts.connect * path_.light(n) * towards_camera_of_connection(n - 1);
                return 1 / (1 + (counts.hit * path_.camera(n) + connected) / nee);
            }
            case TechniqueKind::Light:
                return 1 / (1 + counts.connect * towards_light_of_connection(1) / counts.light);
            case TechniqueKind::Connect:
                return 1 / (1 + towards_camera_of_connection(t.k) +
                            towards_light_of_connection(t.k + 1));
            case TechniqueKind::Merge: {
                const D& z = camera_[static_cast<std::size_t>(t.k)];
                const D& y = light_[static_cast<std::size_t>(t.k)];
                const double towards_camera = z.vcm / eta_ + light_sigma(t.k - 1) * z.vm;
                const double towards_light = y.vcm / eta_ + camera_sigma(t.k + 1) * y.vm;
                return 1 / (1 + towards_camera + towards_light);
            }
        }
        return 0;
    }

 private:
    struct D {
        double vcm = 0;
        double vc = 0;
        double vm = 0;
    };

    double camera_sigma(int i) const {
        return path_.camera(i) / camera_g_[static_cast<std::size_t>(i)];
    }
    double light_sigma(int i) const {
        return i == 0 ? 0 : path_.light(i) / light_g_[static_cast<std::size_t>(i)];
    }
    // Whether merging at x_i is a technique.
    double merges(int i) const { return i > 1 || path_.counts.merge_first ? 1 : 0; }

    D next(const D& before, double forward, double g, double sigma, double merges_before) const {
        return {.vcm = 1 / forward,
                .vc = g / forward * (merges_before * eta_ + before.vcm + sigma * before.vc),
                .vm = g / forward * (merges_before + before.vcm / eta_ + sigma * before.vm)};
    }
    // The camera connects to light paths of which it takes n_light, where others take n_connect.
    void walk_from_camera() {
        camera_[1].vcm = path_.counts.light / path_.counts.connect / path_.camera(1);
        for (int i = 2; i <= path_.n(); ++i) {
            camera_[static_cast<std::size_t>(i)] =
                next(camera_[static_cast<std::size_t>(i - 1)], path_.camera(i),
                     light_g_[static_cast<std::size_t>(i - 1)], light_sigma(i - 2), merges(i - 1));
        }
    }
    // The light's own vertex is connected to by next event estimation, and run into.
    void walk_from_light() {
        const int n = path_.n();
        const double emitted = path_.counts.connect * path_.light(n) * path_.light(n - 1);
        const double g = camera_g_[static_cast<std::size_t>(n)];
        light_[static_cast<std::size_t>(n - 1)] = {
            .vcm = path_.counts.nee * path_.densities.next_event / emitted,
            .vc = path_.counts.hit * g / emitted,
            .vm = path_.counts.hit * g / (emitted * eta_)};
        for (int i = n - 2; i >= 1; --i) {
            light_[static_cast<std::size_t>(i)] = next(
                light_[static_cast<std::size_t>(i + 1)], path_.light(i),
                camera_g_[static_cast<std::size_t>(i + 1)], camera_sigma(i + 2), merges(i + 1));
        }
    }
    double towards_camera_of_connection(int k) const {
        const D& d = camera_[static_cast<std::size_t>(k)];
        return path_.light(k) * (merges(k) * eta_ + d.vcm + light_sigma(k - 1) * d.vc);
    }
    double towards_light_of_connection(int k) const {
        const D& d = light_[static_cast<std::size_t>(k)];
        return path_.camera(k) * (merges(k) * eta_ + d.vcm + camera_sigma(k + 1) * d.vc);
    }

    const Path& path_;
    double eta_;
    const std::vector<double>& camera_g_;  // by vertex of the whole path: of C_i
    const std::vector<double>& light_g_;   // of L_i
    std::vector<D> camera_;                // by vertex of the whole path
    std::vector<D> light_;
};

PathView view_of(const Path& path) {
    PathView view;
    view.densities = &path.densities;
    return view;
}

TEST(PathWeights, AreThoseOfTheRecursiveBalanceHeuristic) {
    RandomPaths random(5);
    const PathWeights weights(Heuristic::parse("balance"));
    PathWeights::Scratch scratch;
    for (int i = 0; i < 3000; ++i) {
        const int n = 2 + i % 24;
        Path path = random.path(n, i % 3 == 0 ? 0.3 : 4);
        path.counts = {.hit = 1,
                       .nee = random.magnitude(1),
                       .light = random.magnitude(5),
                       .connect = random.magnitude(1),
                       .merge = random.magnitude(5),
                       .merge_first = i % 2 == 0};
        const auto camera_g = random.factors(n + 1, 3);
        const auto light_g = random.factors(n + 1, 3);
        const RecursiveWeights recursive(path, camera_g, light_g);
        for (int t = 0; t < n_techniques(n); ++t) {
            const Technique technique = technique_at(t, n);
            if (!is_possible(path, technique)) continue;
            const double w = weights.weigh(view_of(path), path.counts, technique, scratch).w;
            ASSERT_NEAR(w, recursive.weight(technique), 1e-10) << t << " of " << n << " edges";
        }
    }
}

class FixedFactors final : public FactorProvider {
 public:
    explicit FixedFactors(std::vector<double> factors) : factors_(std::move(factors)) {}
    void multiply(const PathView& /*path*/, const TechniqueCounts& /*counts*/,
                  std::span<double> factors) const override {
        for (std::size_t t = 0; t < factors.size(); ++t) factors[t] *= factors_[t];
    }

 private:
    std::vector<double> factors_;
};

std::vector<std::string> names_of_heuristics() {
    std::vector<std::string> names;
    for (const MisHeuristic& row : heuristics()) names.emplace_back(row.name);
    return names;
}

class PathWeightsOf : public testing::TestWithParam<std::string> {
 protected:
    std::vector<double> all_weights(const PathWeights& weights, const Path& path) {
        std::vector<double> all;
        for (int t = 0; t < n_techniques(path.n()); ++t) {
            all.push_back(
                weights.weigh(view_of(path), path.counts, technique_at(t, path.n()), scratch_).w);
        }
        return all;
    }
    Heuristic heuristic_ = Heuristic::parse(GetParam());
    PathWeights::Scratch scratch_;
};

double sum_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum;
}

bool has_technique(const Path& path) {
    DensityScratch<double> scratch;
    const auto q = effective_densities(path.densities, path.counts, scratch);
    return std::any_of(q.begin(), q.end(), [](double q_t) { return q_t > 0; });
}

TEST_P(PathWeightsOf, AllTechniquesSumToOneWithAndWithoutFactors) {
    RandomPaths random(6);
    int n_seen = 0;
    for (int i = 0; i < 2000; ++i) {
        const int n = i % 50 == 0 ? 200 : 1 + i % 20;
        Path path = random.path(n, i % 4 == 0 ? 100 : 5, 0.2 / n, 0.5 / n);
        path.counts = random.counts();
        if (!has_technique(path)) continue;
        ++n_seen;
        for (const auto precision : {DensityPrecision::Double, DensityPrecision::Float}) {
            if (precision == DensityPrecision::Float && i % 4 == 0) continue;
            PathWeights weights(heuristic_, precision);
            ASSERT_NEAR(sum_of(all_weights(weights, path)), 1, 1e-10);
            weights.add(std::make_shared<FixedFactors>(random.factors(n_techniques(n), 30)));
            ASSERT_NEAR(sum_of(all_weights(weights, path)), 1, 1e-10);
            weights.add(std::make_shared<FixedFactors>(random.factors(n_techniques(n), 30)));
            ASSERT_NEAR(sum_of(all_weights(weights, path)), 1, 1e-10);
        }
    }
    EXPECT_GT(n_seen, 1500);
}

TEST_P(PathWeightsOf, FactorsOfOneChangeNoBit) {
    RandomPaths random(7);
    for (int i = 0; i < 500; ++i) {
        const int n = 1 + i % 20;
        Path path = random.path(n, 5, 0.1 / n, 0.5 / n);
        path.counts = random.counts();
        const PathWeights plain(heuristic_);
        PathWeights with_factors(heuristic_);
        with_factors.add(std::make_shared<FixedFactors>(
            std::vector<double>(static_cast<std::size_t>(n_techniques(n)), 1)));
        ASSERT_EQ(all_weights(plain, path), all_weights(with_factors, path));
    }
}

TEST_P(PathWeightsOf, FactorsMultiplyTheDensities) {
    RandomPaths random(8);
    Path path = random.path(6, 1);
    path.counts = {.light = 10, .connect = 1, .merge = 10};
    PathWeights two(heuristic_);
    two.add(std::make_shared<FixedFactors>(std::vector<double>(12, 4)));
    std::vector<double> factors(12, 0.5);
    factors[3] = 8;
    two.add(std::make_shared<FixedFactors>(factors));
    PathWeights one(heuristic_);
    for (double& factor : factors) factor *= 4;
    one.add(std::make_shared<FixedFactors>(factors));
    EXPECT_EQ(all_weights(two, path), all_weights(one, path));

    const Technique technique = technique_at(3, 6);
    const auto weight = two.weigh(view_of(path), path.counts, technique, scratch_);
    EXPECT_THAT(std::vector(weight.factors.begin(), weight.factors.end()),
                testing::ElementsAreArray(factors));
    std::vector<double> product(weight.q.begin(), weight.q.end());
    for (std::size_t t = 0; t < product.size(); ++t) product[t] *= factors[t];
    EXPECT_EQ(weight.w, heuristic_.weight(product, 3));
}

INSTANTIATE_TEST_SUITE_P(Heuristics, PathWeightsOf, testing::ValuesIn(names_of_heuristics()),
                         [](const auto& row) { return row.param; });

}  // namespace
}  // namespace misbench
