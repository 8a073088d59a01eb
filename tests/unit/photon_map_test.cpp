#include "renderer/paths/photon_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>

#include "renderer/methods/thread_pool.h"
#include "tests/support/lights.h"

namespace {

std::atomic<std::size_t> g_n_allocations = 0;

void* counted(void* memory) {
    ++g_n_allocations;
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

// Every allocation of this binary is counted. Inlined, g++ 12 takes the pairs below for mismatched.
[[gnu::noinline]] void* operator new(std::size_t size) { return counted(std::malloc(size)); }
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    const auto a = static_cast<std::size_t>(alignment);
    return counted(std::aligned_alloc(a, (size + a - 1) / a * a));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace misbench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kLargest = std::numeric_limits<float>::max();

struct Answer {
    std::uint32_t index;
    float distance2;
    auto operator<=>(const Answer&) const = default;
};
using Answers = std::vector<Answer>;

void PrintTo(const Answer& answer, std::ostream* out) {
    *out << answer.index << " at " << answer.distance2;
}

Answers ask(const PhotonMap& map, Vec3 centre, float radius) {
    Answers answers;
    map.query(centre, radius, [&](std::uint32_t index, float distance2) {
        answers.push_back({index, distance2});
    });
    return answers;
}

Answers ask_all(std::span<const Vec3> positions, Vec3 centre, float radius) {
    Answers answers;
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const Vec3 d = positions[i] - centre;
        if (dot(d, d) < radius * radius) answers.push_back({i, dot(d, d)});
    }
    return answers;
}

// A set of positions, and how large it is.
struct Set {
    std::string name;
    float size = 1;
    std::vector<Vec3> positions{};
};

std::vector<Vec3> random_positions(std::size_t n, float half_width, Vec3 middle = {}) {
    Rng rng(1, 0, 0);
    std::vector<Vec3> positions(n);
    for (Vec3& p : positions) p = middle + test::random_point(rng, half_width);
    return positions;
}

std::vector<Vec3> on_a_sphere(std::size_t n, float radius) {
    Rng rng(2, 0, 0);
    std::vector<Vec3> positions(n);
    for (Vec3& p : positions) p = radius * test::random_direction(rng);
    return positions;
}

// A dense cluster in a large and sparse cloud: far below the cells of the curve.
std::vector<Vec3> cluster_in_a_cloud() {
    std::vector<Vec3> positions = random_positions(300, 1e6F);
    for (const Vec3 p : random_positions(700, 1e-3F)) positions.push_back(p);
    return positions;
}

// On whole numbers, so that many distances are equal, and equal to a radius.
std::vector<Vec3> on_a_lattice() {
    std::vector<Vec3> positions;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = {static_cast<float>(i % 10), static_cast<float>(i / 10 % 10),
                        static_cast<float>(i / 100)};
        positions.push_back(p);
        if (i % 3 == 0) positions.push_back(p);
    }
    return positions;
}

std::vector<Set> sets() {
    std::vector<Set> sets = {
        {"nothing", 1},
        {"a point", 1, {{1, 2, 3}}},
        {"a point in many places", 1, std::vector<Vec3>(1000, Vec3{1, 2, 3})},
        {"the origin and its mirror image", 1, {{0, 0, 0}, {-0.0F, -0.0F, -0.0F}}},
        {"a line", 1, {}},
        {"a sphere", 1, on_a_sphere(1000, 1)},
        {"a lattice", 10, on_a_lattice()},
        {"tiny", 1e-6F, random_positions(1000, 1e-6F)},
        {"huge", 1e7F, random_positions(1000, 1e7F)},
        {"far away", 8, random_positions(1000, 8, {1e7F, -1e7F, 1e7F})},
        {"a cluster in a cloud", 1e6F, cluster_in_a_cloud()},
        {"all of float", 1e18F, random_positions(1000, kLargest)},
        {"denormal", 1e-22F, random_positions(1000, 1e-40F)},
    };
    for (int i = 0; i < 500; ++i) sets[4].positions.push_back({0, 0.002F * float(i * 7 % 500), 0});
    for (const std::size_t n : {7U, 8U, 9U, 63U, 64U, 65U, 511U, 512U, 513U}) {
        sets.push_back({std::to_string(n), 1, random_positions(n, 1)});
    }
    return sets;
}

// Seven decades below the size and six above, besides radii that are equal to distances.
std::vector<float> radii(float size) {
    std::vector<float> radii = {0, 1, 2, 5, 1e-45F, 1e-30F, kLargest, kInfinity, -1, kNaN};
    for (int i = -14; i <= 12; ++i) {
        radii.push_back(size * std::pow(10.0F, 0.5F * static_cast<float>(i)));
    }
    return radii;
}

std::vector<Vec3> centres(const Set& set) {
    Rng rng(3, 0, 0);
    std::vector<Vec3> centres = {{}, {1, 2, 3}, {kInfinity, 0, 0}, {0, kNaN, 0}, {0, 0, -kLargest}};
    for (std::size_t i = 0; i < set.positions.size(); i += set.positions.size() / 7 + 1) {
        const Vec3 p = set.positions[i];
        centres.push_back(p);
        centres.push_back(p + test::random_point(rng, 1e-3F * set.size));
        centres.push_back(p + test::random_point(rng, set.size));
    }
    return centres;
}

TEST(PhotonMap, FindsWhatALoopOverAllPointsFinds) {
    ThreadPool threads(2);
    PhotonMap map;
    for (const Set& set : sets()) {
        map.build(set.positions, threads);
        std::size_t n_found = 0;
        for (const Vec3 centre : centres(set)) {
            for (const float radius : radii(set.size)) {
                Answers answers = ask(map, centre, radius);
                std::sort(answers.begin(), answers.end());
                const Answers expected =
                    radius > 0 ? ask_all(set.positions, centre, radius) : Answers{};
                ASSERT_EQ(answers, expected) << set.name << ", radius " << radius << ", centre "
                                             << centre.x << " " << centre.y << " " << centre.z;
                n_found += expected.size();
            }
        }
        EXPECT_EQ(n_found == 0, set.positions.empty()) << set.name;
    }
}

TEST(PhotonMap, FindsWhatALoopOverAllPointsFindsAmongMany) {
    const std::vector<Vec3> positions = on_a_sphere(300'000, 1);
    ThreadPool threads(2);
    PhotonMap map;
    map.build(positions, threads);
    Rng rng(4, 0, 0);
    for (const float radius : {1e-3F, 0.01F, 0.1F, 0.7F, 3.0F}) {
        for (int i = 0; i < 10; ++i) {
            const Vec3 centre = 1.001F * test::random_direction(rng);
            Answers answers = ask(map, centre, radius);
            std::sort(answers.begin(), answers.end());
            ASSERT_EQ(answers, ask_all(positions, centre, radius)) << radius;
        }
    }
}

TEST(PhotonMap, LeavesOutPointsAtTheRadius) {
    ThreadPool threads(1);
    PhotonMap map;
    map.build(on_a_lattice(), threads);
    // Two points in the place itself, six one step away from it.
    EXPECT_EQ(ask(map, {4, 4, 4}, 1).size(), 2U);
    EXPECT_EQ(ask(map, {4, 4, 4}, std::nextafter(1.0F, 2.0F)).size(), 8U);
}

TEST(PhotonMap, NeverFindsAPositionThatIsNotFinite) {
    std::vector<Vec3> positions = random_positions(1000, 1);
    for (std::size_t i = 0; i < positions.size(); i += 5) {
        const float bad = std::array{kNaN, kInfinity, -kInfinity}[i % 3];
        positions[i] = std::array{Vec3{bad, 0, 0}, Vec3{0, bad, 0}, Vec3{0, 0, bad},
                                  Vec3{bad, bad, bad}}[i % 4];
    }
    ThreadPool threads(2);
    PhotonMap map;
    map.build(positions, threads);
    EXPECT_EQ(ask(map, {}, kInfinity).size(), 800U);
    for (const float radius : {0.1F, 1.0F, 10.0F}) {
        Answers answers = ask(map, {}, radius);
        std::sort(answers.begin(), answers.end());
        EXPECT_EQ(answers, ask_all(positions, {}, radius));
    }
    map.build(std::vector<Vec3>(100, Vec3{0, kNaN, 0}), threads);
    EXPECT_THAT(ask(map, {}, kInfinity), testing::IsEmpty());
}

TEST(PhotonMap, IsEmptyBeforeTheFirstBuildAndAfterOneOfNothing) {
    ThreadPool threads(2);
    PhotonMap map;
    EXPECT_THAT(ask(map, {}, kInfinity), testing::IsEmpty());
    map.build(random_positions(1000, 1), threads);
    EXPECT_EQ(ask(map, {}, kInfinity).size(), 1000U);
    map.build({}, threads);
    EXPECT_THAT(ask(map, {}, kInfinity), testing::IsEmpty());
}

TEST(PhotonMap, AnswersInTheSameOrderForEveryNumberOfThreads) {
    // Some chunks of every stage of the build, and many equal keys.
    std::vector<Vec3> positions = on_a_sphere(150'000, 1);
    for (std::size_t i = 0; i < positions.size(); i += 2) positions[i] = positions[i % 1000];
    ThreadPool one(1);
    PhotonMap expected;
    expected.build(positions, one);
    for (const int n_threads : {2, 3, 7}) {
        ThreadPool threads(n_threads);
        PhotonMap map;
        map.build(positions, threads);
        for (const float radius : {0.1F, 0.5F, 10.0F}) {
            ASSERT_EQ(ask(map, {1, 0, 0}, radius), ask(expected, {1, 0, 0}, radius)) << n_threads;
        }
    }
}

TEST(PhotonMap, AnswersInTheSameOrderForEveryRadius) {
    ThreadPool threads(2);
    PhotonMap map;
    map.build(on_a_sphere(10'000, 1), threads);
    const Answers all = ask(map, {0, 0, 1}, 10);
    for (const float radius : {0.05F, 0.3F, 1.0F}) {
        Answers expected;
        for (const Answer& answer : all) {
            if (answer.distance2 < radius * radius) expected.push_back(answer);
        }
        EXPECT_EQ(ask(map, {0, 0, 1}, radius), expected);
    }
}

TEST(PhotonMap, BuiltAgainIsLikeANewOne) {
    ThreadPool threads(2);
    PhotonMap map;
    for (const std::size_t n : {5000U, 40'000U, 1U, 513U, 0U, 64U, 40'000U}) {
        const std::vector<Vec3> positions = random_positions(n, 1, {static_cast<float>(n), 0, 0});
        map.build(positions, threads);
        PhotonMap fresh;
        fresh.build(positions, threads);
        for (const float radius : {0.3F, kInfinity}) {
            const Vec3 centre = {static_cast<float>(n), 0, 0};
            EXPECT_EQ(ask(map, centre, radius), ask(fresh, centre, radius)) << n;
        }
        EXPECT_EQ(ask(map, {}, kInfinity).size(), n);
    }
}

TEST(PhotonMap, AllocatesNothingOnceItIsWarm) {
    const std::vector<Vec3> many = random_positions(100'000, 1);
    const std::vector<Vec3> few = random_positions(70'000, 3);
    ThreadPool threads(2);
    PhotonMap map;
    map.build(many, threads);
    const std::size_t n_before = g_n_allocations;
    EXPECT_GT(n_before, 0U);
    std::size_t n_found = 0;
    for (const auto* positions : {&few, &many, &few, &many}) {
        map.build(*positions, threads);
        map.query({}, 0.5F, [&](std::uint32_t, float) { ++n_found; });
    }
    EXPECT_EQ(g_n_allocations, n_before);
    EXPECT_GT(n_found, 0U);
}

TEST(PhotonMap, AnswersManyThreadsAtTheSameTime) {
    const std::vector<Vec3> positions = on_a_sphere(10'000, 1);
    ThreadPool threads(4);
    PhotonMap map;
    map.build(positions, threads);
    std::vector<Answers> answers(200);
    threads.for_each(
        answers.size(), [] { return false; },
        [&](std::size_t i) { answers[i] = ask(map, positions[i], 0.2F); });
    for (std::size_t i = 0; i < answers.size(); ++i) {
        std::sort(answers[i].begin(), answers[i].end());
        ASSERT_EQ(answers[i], ask_all(positions, positions[i], 0.2F));
    }
}

}  // namespace
}  // namespace misbench
