#include "results/moments.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "renderer/base/check.h"
#include "renderer/base/error.h"
#include "renderer/base/log.h"
#include "renderer/base/sha256.h"
#include "results/run_directory.h"
#include "results/sqlite.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kM2Layer = "m2";
constexpr const char* kRunsAttribute = "runs";
constexpr std::size_t kIdDigits = 32;

// The key of a set of runs.
std::string joined(std::vector<std::string> runs) {
    std::ranges::sort(runs);
    std::string text;
    for (const std::string& run : runs) text += (text.empty() ? "" : " ") + run;
    return text;
}

fs::path moments_path(const fs::path& store, const std::string& key) {
    return store / kMomentsFolder / (sha256_hex(key).substr(0, kIdDigits) + ".exr");
}

PixelMoments computed(const fs::path& store, const std::vector<std::string>& runs) {
    MomentSums sums;
    for (const std::string& run : runs) sums.add(read_exr(store / "runs" / run / kImageFile));
    return sums.moments();
}

std::optional<PixelMoments> read(const fs::path& path, const std::string& key, std::size_t n) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return std::nullopt;
    try {
        ExrLayers file = read_exr_layers(path, std::vector<std::string>{"", kM2Layer});
        if (file.attributes[kRunsAttribute] != key) {
            throw Error(Errc::DataLoss, "read '" + path.string() + "': it is of other runs");
        }
        return PixelMoments{.n = static_cast<int>(n),
                            .mean = std::move(file.images[0].image),
                            .m2 = std::move(file.images[1].image)};
    } catch (const Error& e) {
        spdlog::warn("moments passed over error={}", e.what());
        return std::nullopt;
    }
}

// Valid runs of each cell over its seeds, by key.
std::map<std::string, std::vector<std::string>> cells_of(const Database& database) {
    Statement select = database.prepare(
        "SELECT json_array(c.experiment, c.scene, c.method, c.budget, r.width, r.height), c.task "
        "FROM cells c JOIN runs r ON r.id = c.task WHERE c.role = 'test' AND r.valid = 1");
    std::map<std::string, std::set<std::string>> by_cell;
    while (select.step()) by_cell[select.text(0)].insert(select.text(1));
    std::map<std::string, std::vector<std::string>> by_key;
    for (const auto& [cell, runs] : by_cell) {
        const std::vector<std::string> sorted(runs.begin(), runs.end());
        if (sorted.size() > 1) by_key[joined(sorted)] = sorted;
    }
    return by_key;
}

}  // namespace

// The mean comes from plain sums, so that it is the same for every order that has the same sums; m2
// grows by the product of the distances from the mean before and after.
void MomentSums::add(const Image& image) {
    if (n_ == 0) {
        width_ = image.width;
        height_ = image.height;
        sums_.assign(image.rgb.size(), 0);
        m2_.assign(image.rgb.size(), 0);
    }
    MISBENCH_CHECK(image.width == width_ && image.height == height_);
    const double before = n_;
    ++n_;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        const double value = image.rgb[i];
        const double distance = before > 0 ? value - sums_[i] / before : 0;
        sums_[i] += value;
        m2_[i] += distance * (value - sums_[i] / n_);
    }
}

// Σ (x - m)² over both groups is m2 of each, plus (difference of their means)² n n'/(n + n').
void MomentSums::merge(const MomentSums& other) {
    if (other.n_ == 0) return;
    if (n_ == 0) {
        *this = other;
        return;
    }
    MISBENCH_CHECK(other.width_ == width_ && other.height_ == height_);
    const double here = n_;
    const double there = other.n_;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        const double distance = sums_[i] / here - other.sums_[i] / there;
        m2_[i] += other.m2_[i] + distance * distance * here * there / (here + there);
        sums_[i] += other.sums_[i];
    }
    n_ += other.n_;
}

PixelMoments MomentSums::moments() const {
    MISBENCH_CHECK(n_ > 0);
    PixelMoments moments{.n = n_, .mean = Image(width_, height_), .m2 = Image(width_, height_)};
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        moments.mean.rgb[i] = static_cast<float>(sums_[i] / n_);
        moments.m2.rgb[i] = static_cast<float>(m2_[i]);
    }
    return moments;
}

PixelMoments read_or_compute_moments(const fs::path& store, const std::vector<std::string>& runs) {
    MISBENCH_CHECK(!runs.empty());
    const std::string key = joined(runs);
    if (auto kept = read(moments_path(store, key), key, runs.size())) return *kept;
    return computed(store, runs);
}

int update_moments(const Database& database, const fs::path& store) {
    fs::create_directories(store / kMomentsFolder);
    int n_made = 0;
    std::set<fs::path> wanted;
    for (const auto& [key, runs] : cells_of(database)) {
        const fs::path path = moments_path(store, key);
        wanted.insert(path);
        if (fs::exists(path)) continue;
        const PixelMoments moments = computed(store, runs);
        write_exr_layers(
            path, std::array{ImageLayer{"", &moments.mean}, ImageLayer{kM2Layer, &moments.m2}},
            {{kRunsAttribute, key}});
        ++n_made;
    }
    std::vector<fs::path> unwanted;
    for (const auto& entry : fs::directory_iterator(store / kMomentsFolder)) {
        if (!wanted.contains(entry.path())) unwanted.push_back(entry.path());
    }
    for (const fs::path& path : unwanted) fs::remove(path);
    return n_made;
}

}  // namespace misbench
