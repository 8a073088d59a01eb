#include "tests/support/image_agreement.h"

#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>

#include "renderer/base/check.h"
#include "renderer/methods/thread_pool.h"

namespace misbench::test {
namespace {

constexpr double kPower = 0.8;
constexpr int kSecondLook = 4;  // times the seeds of the first
// Seeds of different sources must not be the same: their images would depend on each other.
constexpr std::int64_t kSeedsOfSource = 1'000'000;

// The tiles of one size.
std::vector<PixelRange> tiles(int width, int height, int side) {
    std::vector<PixelRange> all;
    for (int y = 0; y < height; y += side) {
        for (int x = 0; x < width; x += side) {
            all.push_back({x, y, std::min(x + side, width), std::min(y + side, height)});
        }
    }
    return all;
}

// Smallest first; a tile that covers the image is the whole image.
std::vector<int> sides(int width, int height) {
    const int largest = std::max(width, height);
    std::vector<int> all;
    for (const int side : kTileSides) {
        if (side < largest) all.push_back(side);
    }
    all.push_back(largest);
    return all;
}

std::size_t n_pixels(const PixelRange& tile, int width, const PixelMask& mask) {
    std::size_t n = 0;
    for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) n += mask[static_cast<std::size_t>(y * width + x)];
    }
    return n;
}

MeanOfSeeds mean_of(std::span<const Image> images, const PixelRange& tile, int channel,
                    const PixelMask& mask, std::size_t n) {
    std::vector<double> means;
    for (const Image& image : images) {
        double sum = 0;
        for (int y = tile.y0; y < tile.y1; ++y) {
            for (int x = tile.x0; x < tile.x1; ++x) {
                const auto pixel = static_cast<std::size_t>(y * image.width + x);
                if (mask[pixel]) {
                    sum += double{image.rgb[3 * pixel + static_cast<std::size_t>(channel)]};
                }
            }
        }
        means.push_back(sum / static_cast<double>(n));
    }
    const auto m = static_cast<double>(means.size());
    MeanOfSeeds result;
    for (const double mean : means) result.value += mean / m;
    double m2 = 0;
    double m3 = 0;
    for (const double mean : means) {
        const double d = mean - result.value;
        m2 += d * d;
        m3 += d * d * d;
    }
    result.standard_error = std::sqrt(m2 / (m - 1) / m);
    result.third_moment = m3 / ((m - 1) * (m - 2)) / m;
    return result;
}

double standard_error(const TileTest& test) {
    return std::hypot(test.first.standard_error, test.second.standard_error);
}
double brightness(const TileTest& test) {
    return 0.5 * (std::abs(test.first.value) + std::abs(test.second.value));
}

// t = (m_1 - m_2) / √(v_1 + v_2) with ν = (v_1 + v_2)² / (v_1² / (n_1 - 1) + v_2² / (n_2 - 1)), v
// the squares of the standard errors; of the difference, what is allowed is taken away.  [JHD20]
void decide(TileTest& test, std::size_t n_first, std::size_t n_second) {
    const double se = standard_error(test);
    const double v1 = test.first.standard_error * test.first.standard_error / (se * se);
    const double v2 = 1 - v1;
    const auto n1 = static_cast<double>(n_first - 1);
    const auto n2 = static_cast<double>(n_second - 1);
    // Where both are without noise the degrees of freedom do not matter.
    test.degrees_of_freedom = se > 0 ? 1 / (v1 * v1 / n1 + v2 * v2 / n2) : std::min(n1, n2);
    const double difference = test.first.value - test.second.value;
    const double excess = std::abs(difference) - test.allowed;
    if (excess <= 0) {
        test.p_value = 1;
        return;
    }
    if (se == 0) {
        test.p_value = 0;
        return;
    }
    // Take the skewness δ of the difference out of t, where that lessens it.  [Hal92], [ZD05]
    double t = std::copysign(excess / se, difference);
    const double delta = (test.first.third_moment - test.second.third_moment) / (se * se * se);
    const double straight = t + delta * t * t / 3 + delta * delta * t * t * t / 27 + delta / 6;
    if (std::abs(straight) < std::abs(t)) t = straight;
    const boost::math::students_t distribution(test.degrees_of_freedom);
    test.p_value = 2 * boost::math::cdf(boost::math::complement(distribution, std::abs(t)));
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

PixelMask both(const PixelMask& a, const PixelMask& b) {
    PixelMask mask(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) mask[i] = a[i] && b[i];
    return mask;
}

// The images of sources by the seeds [first, first + n) of each.
using Images = std::vector<std::vector<Image>>;

void render(std::span<const ImageSource> sources, const std::set<std::size_t>& wanted, int first,
            int n, ThreadPool& threads, Images& images) {
    struct Job {
        std::size_t source;
        int seed;
    };
    std::vector<Job> jobs;
    for (const std::size_t s : wanted) {
        images[s].resize(static_cast<std::size_t>(n));
        for (int i = 0; i < n; ++i) jobs.push_back({s, i});
    }
    const auto never = [] { return false; };
    threads.for_each(jobs.size(), never, [&](std::size_t j) {
        const auto [s, i] = jobs[j];
        const std::int64_t seed = kSeedsOfSource * static_cast<std::int64_t>(s + 1) + first + i;
        images[s][static_cast<std::size_t>(i)] = sources[s].image(seed);
    });
}

struct PairTest {
    std::size_t first = 0;
    std::size_t second = 0;
    std::size_t index = 0;  // in the result of welch_tests
    TileTest test;
};

std::vector<PairTest> tests_of(std::span<const ImageSource> sources, const Images& images,
                               std::size_t a, std::size_t b) {
    std::vector<PairTest> all;
    const std::vector<TileTest> tests =
        welch_tests(images[a], images[b], both(sources[a].mask, sources[b].mask),
                    sources[a].bias + sources[b].bias);
    for (std::size_t i = 0; i < tests.size(); ++i) all.push_back({a, b, i, tests[i]});
    return all;
}

// The largest p-value among the discoveries of all tests.
double limit(std::span<const PairTest> tests, double false_discovery_rate) {
    std::vector<double> p_values;
    for (const PairTest& test : tests) p_values.push_back(test.test.p_value);
    return largest_discovery(std::move(p_values), false_discovery_rate);
}

Difference describe(std::span<const ImageSource> sources, const std::string& scene,
                    const PairTest& found, int n_seeds) {
    const TileTest& test = found.test;
    std::ostringstream text;
    text.precision(4);
    const auto mean = [&](const std::string& name, const MeanOfSeeds& m) {
        text << name << ' ' << m.value << " ± " << m.standard_error;
    };
    text << "scene '" << scene << "', pixels x " << test.tile.x0 << " … " << test.tile.x1 - 1
         << ", y " << test.tile.y0 << " … " << test.tile.y1 - 1 << ", "
         << std::array{"red", "green", "blue"}[static_cast<std::size_t>(test.channel)] << ": ";
    mean(sources[found.first].name, test.first);
    mean(" against " + sources[found.second].name, test.second);
    text << " (" << n_seeds << " seeds, p = " << test.p_value << ")";
    return {text.str(), test.p_value};
}

void find_detectable_bias(std::span<const PairTest> tests, double false_discovery_rate,
                          Agreement& agreement) {
    // The level at which a single tile is found among all of them.
    const double level = false_discovery_rate / static_cast<double>(tests.size());
    std::vector<double> of_tiles;
    std::vector<double> of_images;
    for (const auto& [first, second, index, test] : tests) {
        if (brightness(test) == 0) continue;
        const double relative = test.detectable(level) / brightness(test);
        if (test.tile.x1 - test.tile.x0 <= kTileSides[0]) of_tiles.push_back(relative);
        if (test.is_image) of_images.push_back(relative);
    }
    agreement.detectable_bias_of_tile = median(std::move(of_tiles));
    agreement.detectable_bias_of_image = median(std::move(of_images));
}

}  // namespace

double TileTest::detectable(double level) const {
    const boost::math::students_t t(degrees_of_freedom);
    const double quantiles = boost::math::quantile(boost::math::complement(t, level / 2)) +
                             boost::math::quantile(t, kPower);
    return allowed + quantiles * standard_error(*this);
}

std::vector<TileTest> welch_tests(std::span<const Image> first, std::span<const Image> second,
                                  const PixelMask& mask, double bias) {
    MISBENCH_CHECK(first.size() >= 3 && second.size() >= 3);
    const int width = first[0].width;
    const int height = first[0].height;
    for (const std::span<const Image> images : {first, second}) {
        for (const Image& image : images) {
            MISBENCH_CHECK(image.width == width && image.height == height);
            MISBENCH_CHECK(image.n_pixels() == mask.size());
        }
    }
    std::vector<TileTest> all;
    for (const int side : sides(width, height)) {
        std::vector<TileTest> tests;
        std::vector<double> brightnesses;
        for (const PixelRange& tile : tiles(width, height, side)) {
            const std::size_t n = n_pixels(tile, width, mask);
            for (int channel = 0; n > 0 && channel < 3; ++channel) {
                tests.push_back({.tile = tile,
                                 .is_image = side >= std::max(width, height),
                                 .channel = channel,
                                 .first = mean_of(first, tile, channel, mask, n),
                                 .second = mean_of(second, tile, channel, mask, n)});
                brightnesses.push_back(brightness(tests.back()));
            }
        }
        const double typical = median(brightnesses);
        for (TileTest& test : tests) {
            test.allowed =
                kRounding * brightness(test) + bias * std::max(brightness(test), typical);
            decide(test, first.size(), second.size());
            all.push_back(test);
        }
    }
    return all;
}

double largest_discovery(std::vector<double> p_values, double false_discovery_rate) {
    std::sort(p_values.begin(), p_values.end());
    const auto n = static_cast<double>(p_values.size());
    for (std::size_t k = p_values.size(); k > 0; --k) {
        if (p_values[k - 1] <= static_cast<double>(k) / n * false_discovery_rate) {
            return p_values[k - 1];
        }
    }
    return -1;
}

Agreement compare_all_pairs(std::span<const ImageSource> sources, const AgreementTest& test) {
    ThreadPool threads(test.n_threads);
    Images images(sources.size());
    std::set<std::size_t> wanted;
    for (std::size_t s = 0; s < sources.size(); ++s) wanted.insert(s);
    render(sources, wanted, 0, test.n_seeds, threads, images);

    std::vector<PairTest> tests;
    for (std::size_t a = 0; a < sources.size(); ++a) {
        for (std::size_t b = a + 1; b < sources.size(); ++b) {
            for (const PairTest& pair : tests_of(sources, images, a, b)) tests.push_back(pair);
        }
    }
    Agreement agreement;
    agreement.n_tests = tests.size();
    find_detectable_bias(tests, test.false_discovery_rate, agreement);
    std::vector<PairTest> found;
    const double found_limit = limit(tests, test.false_discovery_rate);
    std::copy_if(tests.begin(), tests.end(), std::back_inserter(found),
                 [&](const PairTest& pair) { return pair.test.p_value <= found_limit; });
    if (found.empty()) return agreement;

    // Look at the same tiles of the same pairs by other seeds.
    wanted.clear();
    for (const PairTest& pair : found) wanted.insert({pair.first, pair.second});
    const int n_again = kSecondLook * test.n_seeds;
    render(sources, wanted, test.n_seeds, n_again, threads, images);
    std::vector<PairTest> again;
    std::vector<PairTest> of_pair;
    for (const PairTest& pair : found) {
        if (again.empty() || again.back().first != pair.first ||
            again.back().second != pair.second) {
            of_pair = tests_of(sources, images, pair.first, pair.second);
        }
        again.push_back(of_pair[pair.index]);
    }
    const double again_limit = limit(again, test.false_discovery_rate);
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (again[i].test.p_value <= again_limit) {
            agreement.disagreements.push_back(describe(sources, test.scene, again[i], n_again));
        } else {
            agreement.withdrawn.push_back(describe(sources, test.scene, found[i], test.n_seeds));
        }
    }
    return agreement;
}

}  // namespace misbench::test
