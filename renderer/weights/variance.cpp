// p    a technique's estimate of a pixel in one pass, its samples' weights left out; 0 where it has
//      none
// μ    mean of p, σ² its variance, over a tile's pixels or around a pixel, and over the passes
// m    the sum of the squares of a pixel's single samples
// v    the factor
#include "renderer/weights/variance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "renderer/base/error.h"
#include "renderer/base/names.h"
#include "renderer/mis/factors.h"
#include "renderer/paths/pixel_sums.h"
#include "renderer/paths/technique_images.h"
#include "renderer/weights/filters.h"

namespace misbench {
namespace {

struct Variant {
    std::string_view name;
    bool (*has)(int n_edges, TechniqueKind kind);  // whether such a technique has a factor
    // The second moment of single samples, E[Σ (f / n p)²] (hua2025 Eq. 11); else that of the
    // pixel, μ² + σ² (grittmann2019 Eq. 7).
    bool of_single_samples;
    int blur_radius;
    int blur_passes;  // 0: tiles
};
bool is_merge(TechniqueKind kind) { return kind == TechniqueKind::Merge; }
constexpr std::array kVariants{
    Variant{"grittmann2019", [](int, TechniqueKind) { return true; }, false, 1, 0},
    Variant{"grittmann2021", [](int, TechniqueKind kind) { return is_merge(kind); }, true, 4, 1},
    Variant{"hua2025", [](int n, TechniqueKind kind) { return n == 2 || is_merge(kind); }, true, 1,
            4},
    Variant{"hua2025-light",
            [](int n, TechniqueKind kind) {
                return is_merge(kind) || (n == 2 && kind == TechniqueKind::Light);
            },
            true, 1, 4},
};
const Variant& find_variant(const std::string& name) {
    return find_named(kVariants, name, "variance_variant", "variance variant");
}

constexpr float kLeastFactor = 1e-30F;
constexpr float kLargestFactor = 1e30F;
constexpr double kLeastSpread = 1e-12;  // σ² / μ² of what does not vary
constexpr double kUnknown = std::numeric_limits<double>::infinity();  // σ² of a single value

class Variance final : public FactorProvider, private SampleObserver {
 public:
    explicit Variance(const VarianceParameters& parameters)
        : parameters_(parameters), variant_(find_variant(parameters.variant)) {
        if (parameters.blur > 0) {
            variant_.blur_radius = 1;
            variant_.blur_passes = static_cast<int>(parameters.blur);
        }
    }

    Place place() const override { return Place::Shares; }
    bool never_stops_learning() const override { return parameters_.update; }

    void start(const Scene& /*scene*/, FrameInfo frame) override {
        frame_ = frame;
        side_ = uses_tiles() ? static_cast<int>(parameters_.tile) : 1;
        n_columns_ = (frame.width + side_ - 1) / side_;
        n_cells_ = static_cast<std::size_t>(n_columns_) *
                   static_cast<std::size_t>((frame.height + side_ - 1) / side_);
        samples_.emplace(n_pixels(), n_channels());
    }

    SampleObserver* trainer() override { return this; }

    Forgotten finish_pass(ThreadPool& threads, bool is_last) override {
        ++n_passes_;
        for (const auto& [key, image] : samples_->images()) {
            add(image, cells_[key]);
        }
        samples_->clear();
        if (!is_last && !parameters_.update) return {};
        std::size_t column = 0;
        columns_.assign(static_cast<std::size_t>(first_technique_key(max_depth() + 1)), kNoColumn);
        factors_.assign(n_cells_ * cells_.size(), 1.0F);
        for (auto& [key, sums] : cells_) {
            columns_[static_cast<std::size_t>(key)] = static_cast<int>(column);
            if (uses_tiles()) {
                estimate_by_tiles(sums, column);
            } else {
                estimate_by_blur(sums, column, threads);
            }
            if (!parameters_.update) sums = {};  // no more is learned
            ++column;
        }
        return is_last ? forgotten() : Forgotten{};
    }

    void multiply(const PathView& path, const TechniqueCounts& /*counts*/,
                  std::span<double> factors) const override {
        const int n = path.n_edges();
        if (factors_.empty() || n > max_depth()) return;
        const auto first = static_cast<std::size_t>(first_technique_key(n));
        const float* of_cell =
            factors_.data() + cells_.size() * cell_of(path.pixel.x, path.pixel.y);
        for (std::size_t t = 0; t < factors.size(); ++t) {
            const int column = columns_[first + t];
            if (column != kNoColumn) {
                factors[t] *= double{of_cell[column]};
            } else if (is_reciprocal() && has(n, technique_at(static_cast<int>(t), n))) {
                factors[t] *= double{kLeastFactor};  // as where no sample was found
            }
        }
    }

    void describe(nlohmann::json& json) const override {
        if (factors_.empty()) return;
        double sum = 0;
        for (const float v : factors_) sum += double{v};
        json["variance"] = {
            {"techniques", cells_.size()},
            {"mean", sum / static_cast<double>(factors_.size())},
            {"largest", *std::max_element(factors_.begin(), factors_.end())},
            {"bytes", factors_.size() * sizeof(float)},
        };
    }

    std::vector<NamedImage> maps() const override {
        std::vector<NamedImage> maps;
        if (factors_.empty()) return maps;
        int n_edges = 1;
        for (const auto& [key, sums] : cells_) {
            while (key >= first_technique_key(n_edges + 1)) ++n_edges;
            const Technique technique = technique_at(key - first_technique_key(n_edges), n_edges);
            const int column = columns_[static_cast<std::size_t>(key)];
            NamedImage map{
                .name = "variance.n" + std::to_string(n_edges) + "." + technique_name(technique),
                .image = Image(frame_.width, frame_.height)};
            for (std::size_t i = 0; i < map.image.rgb.size(); ++i) {
                map.image.rgb[i] = factors_[cells_.size() * cell_of_pixel(i / 3) +
                                            static_cast<std::size_t>(column)];
            }
            maps.push_back(std::move(map));
        }
        return maps;
    }

 private:
    static constexpr int kNoColumn = -1;

    bool has(int n_edges, Technique technique) const {
        return n_edges >= 2 && variant_.has(n_edges, technique.kind);
    }
    bool is_reciprocal() const { return parameters_.factor == "reciprocal"; }
    bool uses_tiles() const { return variant_.blur_passes == 0; }
    int max_depth() const { return static_cast<int>(parameters_.max_depth); }
    std::size_t n_channels() const { return variant_.of_single_samples ? 2 : 1; }
    std::size_t n_pixels() const {
        return static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height);
    }
    std::size_t cell_of(int x, int y) const {
        return static_cast<std::size_t>(y / side_) * static_cast<std::size_t>(n_columns_) +
               static_cast<std::size_t>(x / side_);
    }
    std::size_t cell_of_pixel(std::size_t pixel) const {
        const auto i = static_cast<int>(pixel);
        return cell_of(i % frame_.width, i / frame_.width);
    }

    // ---- Training.

    void start_phase(std::size_t n_chunks) override { samples_->start_phase(n_chunks); }
    void finish_phase() override { samples_->finish_phase(); }
    void observe(const Sample& sample, std::size_t chunk) override {
        const int n = sample.path.n_edges();
        if (n > max_depth() || !has(n, sample.technique)) return;
        const float p = luminance(sample.value);
        if (!std::isfinite(p)) return;
        const std::array values = {p, p * p};
        samples_->add(sample, chunk, technique_key(n, sample.technique),
                      sample.path.pixel.index(frame_.width), std::span(values).first(n_channels()));
    }

    // Sums over the passes, of a cell's pixels.
    struct Sums {
        double p = 0;
        double p2 = 0;
        double m = 0;
    };

    void add(std::span<const float> image, std::vector<Sums>& cells) const {
        cells.resize(n_cells_);
        for (std::size_t i = 0; i < n_pixels(); ++i) {
            const float* values = &image[n_channels() * i];
            const double p = double{values[0]};
            Sums& sums = cells[cell_of_pixel(i)];
            sums.p += p;
            sums.p2 += p * p;
            if (variant_.of_single_samples) sums.m += double{values[1]};
        }
    }

    void estimate_by_tiles(std::span<const Sums> cells, std::size_t column) {
        const int n_rows = static_cast<int>(n_cells_) / n_columns_;
        for (int row = 0; row < n_rows; ++row) {
            for (int at = 0; at < n_columns_; ++at) {
                // Tiles at the right and lower edges are smaller.
                const int width = std::min(side_, frame_.width - at * side_);
                const int height = std::min(side_, frame_.height - row * side_);
                const double n = static_cast<double>(n_passes_) * width * height;
                const auto cell = static_cast<std::size_t>(row * n_columns_ + at);
                const Sums& sums = cells[cell];
                const double mean = sums.p / n;
                const double variance = n > 1 ? (sums.p2 - n * mean * mean) / (n - 1) : kUnknown;
                factors_[cell * cells_.size() + column] = factor(mean, variance, sums.m / n);
            }
        }
    }

    void estimate_by_blur(std::span<const Sums> pixels, std::size_t column, ThreadPool& threads) {
        const auto n = static_cast<double>(n_passes_);
        Plane mean(frame_.width, frame_.height);
        Plane spread(frame_.width, frame_.height);
        Plane moment(frame_.width, frame_.height);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            mean.values[i] = static_cast<float>(pixels[i].p / n);
            moment.values[i] = static_cast<float>(pixels[i].m / n);
        }
        blur(mean, threads);
        blur(moment, threads);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const double b = double{mean.values[i]};
            // Around the blurred mean, over the passes.
            const double squares = (pixels[i].p2 - 2 * b * pixels[i].p) / n + b * b;
            spread.values[i] = static_cast<float>(std::max(squares, 0.0));
        }
        blur(spread, threads);
        Plane factors(frame_.width, frame_.height);
        const bool is_single = n_passes_ == 1 && n_pixels() == 1;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const double variance = is_single ? kUnknown : double{spread.values[i]};
            factors.values[i] = factor(double{mean.values[i]}, variance, double{moment.values[i]});
        }
        blur(factors, threads);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            factors_[i * cells_.size() + column] = factors.values[i];
        }
    }
    void blur(Plane& plane, ThreadPool& threads) const {
        box_filter(plane, variant_.blur_radius, variant_.blur_passes, threads);
    }

    float factor(double mean, double variance, double moment) const {
        const double spread = std::max(variance, kLeastSpread * mean * mean);
        if (is_reciprocal()) {
            const double reciprocal = 1 / spread;
            const bool is_known = mean > 0 && reciprocal > double{kLeastFactor};
            return is_known ? static_cast<float>(std::min(reciprocal, double{kLargestFactor}))
                            : kLeastFactor;
        }
        const double second_moment = variant_.of_single_samples ? moment : mean * mean + variance;
        return std::max(static_cast<float>(variance_factor(second_moment, spread)), kLeastFactor);
    }

    // Pixels of tiles in which a factor is too large for samples that were weighed without it.
    Forgotten forgotten() const {
        if (!uses_tiles() || parameters_.update) return {};
        Forgotten forgotten{.pixels = std::vector<std::uint8_t>(n_pixels())};
        for (std::size_t i = 0; i < n_pixels(); ++i) {
            const auto begin =
                factors_.begin() + static_cast<std::ptrdiff_t>(cells_.size() * cell_of_pixel(i));
            const auto end = begin + static_cast<std::ptrdiff_t>(cells_.size());
            const bool keeps =
                std::all_of(begin, end, [&](float v) { return double{v} <= parameters_.keep; });
            forgotten.pixels[i] = keeps ? 0 : 1;
        }
        return forgotten;
    }

    VarianceParameters parameters_;
    Variant variant_;
    FrameInfo frame_{};
    int side_ = 1;  // of a cell, in pixels
    int n_columns_ = 0;
    std::size_t n_cells_ = 0;

    std::optional<PixelSums<float>> samples_;  // of the pass
    std::int64_t n_passes_ = 0;
    std::map<int, std::vector<Sums>> cells_;  // by technique_key()

    std::vector<int> columns_;    // by technique_key(): of its factors
    std::vector<float> factors_;  // cell by cell, a column for each technique
};

}  // namespace

void VarianceParameters::check() const {
    find_variant(variant);
    check_choice("variance_factor", factor, {"ratio", "reciprocal"});
    constexpr std::int64_t kMax = 1 << 14;
    check_range("variance_tile", tile, std::int64_t{1}, kMax);
    check_range("variance_blur", blur, std::int64_t{0}, kMax);
    check_range("variance_max_depth", max_depth, std::int64_t{2}, std::int64_t{100});
    check_range("variance_keep", keep, 0.0, 1e30);
}

std::shared_ptr<FactorProvider> make_variance(const VarianceParameters& parameters) {
    return std::make_shared<Variance>(parameters);
}

}  // namespace misbench
