// F_γ   a pixel's value in one pass, were the weights corrected by γ; the mean of three channels
// M_γ   its second moment
#include "renderer/weights/correction.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "renderer/base/error.h"
#include "renderer/base/names.h"
#include "renderer/mis/factors.h"
#include "renderer/paths/pixel_sums.h"
#include "renderer/weights/filters.h"

namespace misbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxCandidates = 64;
constexpr double kLeastCandidate = 1e-30;  // far from where floats end
constexpr double kLargestCandidate = 1e30;

// Techniques that share a factor, on the paths of so many edges.
struct Group {
    std::string_view name;
    TechniqueKind kind;
    int min_edges;
    int max_edges;

    bool concerns(int n_edges) const { return n_edges >= min_edges && n_edges <= max_edges; }
    // Calls visit(index) for each of its techniques.
    template <class Visit>
    void for_each(int n_edges, const Visit& visit) const {
        if (kind != TechniqueKind::Merge) {
            visit(static_cast<std::size_t>(Technique{kind}.index(n_edges)));
            return;
        }
        for (int k = 1; k < n_edges; ++k) {
            visit(static_cast<std::size_t>(Technique{kind, k}.index(n_edges)));
        }
    }
};
constexpr int kAny = std::numeric_limits<int>::max();
constexpr std::array kGroups{
    Group{"merge", TechniqueKind::Merge, 3, kAny},
    Group{"light", TechniqueKind::Light, 2, 2},
    Group{"nee", TechniqueKind::NextEvent, 2, kAny},
    Group{"hit", TechniqueKind::Hit, 2, 2},
};

std::vector<Group> parse_groups(const std::string& text) {
    std::vector<Group> groups;
    for (const std::string& name : split(text, '+')) {
        const Group& group = find_named(kGroups, name, "correction_groups", "group");
        if (std::any_of(groups.begin(), groups.end(),
                        [&](const Group& other) { return other.name == group.name; })) {
            throw ParameterError("correction_groups",
                                 "correction_groups has '" + name + "' more than once");
        }
        groups.push_back(group);
    }
    return groups;
}

// 1 is the last of them.
std::vector<double> parse_candidates(const std::string& text) {
    std::vector<double> candidates;
    for (const std::string& part : split(text, ',')) {
        double value = 0;
        const auto [end, status] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (status != std::errc() || end != part.data() + part.size() ||
            !(value >= kLeastCandidate && value <= kLargestCandidate)) {
            throw ParameterError("correction_candidates",
                                 "correction_candidates has '" + part +
                                     "', expected numbers between " + to_string(kLeastCandidate) +
                                     " and " + to_string(kLargestCandidate) + " with commas");
        }
        if (value != 1) candidates.push_back(value);
    }
    if (candidates.size() >= kMaxCandidates) {
        throw ParameterError("correction_candidates", "correction_candidates has more than " +
                                                          std::to_string(kMaxCandidates));
    }
    candidates.push_back(1);
    return candidates;
}

class Correction final : public FactorProvider, private SampleObserver {
 public:
    explicit Correction(const CorrectionParameters& parameters)
        : parameters_(parameters), candidates_(parse_candidates(parameters.candidates)) {
        for (const Group& group : parse_groups(parameters.groups)) {
            searches_.push_back({.group = group});
        }
    }

    Place place() const override { return Place::Shares; }

    void start(const Scene& /*scene*/, FrameInfo frame) override {
        frame_ = frame;
        samples_.emplace(n_pixels(), candidates_.size());
        if (parameters_.filter == "bilateral") features_.resize(n_pixels());
    }

    SampleObserver* trainer() override { return this; }

    Forgotten finish_pass(ThreadPool& threads, bool is_last) override {
        ++n_passes_;
        for (const auto& [key, image] : samples_->images()) {
            searches_[static_cast<std::size_t>(key)].add(image, candidates_.size());
        }
        samples_->clear();
        if (!is_last) return {};
        for (Search& search : searches_) choose(search, threads);
        features_.clear();
        return {.all = !parameters_.keep};
    }

    void multiply(const PathView& path, const TechniqueCounts& /*counts*/,
                  std::span<double> factors) const override {
        for (const Search& search : searches_) {
            if (search.factors.values.empty() || !search.group.concerns(path.n_edges())) continue;
            const float gamma = search.factors.values[path.pixel.index(frame_.width)];
            search.group.for_each(path.n_edges(),
                                  [&](std::size_t t) { factors[t] *= double{gamma}; });
        }
    }

    void describe(nlohmann::json& json) const override {
        for (const Search& search : searches_) {
            if (search.factors.values.empty()) continue;
            const auto& values = search.factors.values;
            double sum = 0;
            for (const float gamma : values) sum += double{gamma};
            json["correction"][std::string(search.group.name)] = {
                {"mean", sum / static_cast<double>(values.size())},
                {"least", *std::min_element(values.begin(), values.end())},
                {"largest", *std::max_element(values.begin(), values.end())},
            };
        }
    }

    std::vector<NamedImage> maps() const override {
        std::vector<NamedImage> maps;
        for (const Search& search : searches_) {
            if (search.factors.values.empty()) continue;
            NamedImage map{.name = "correction." + std::string(search.group.name),
                           .image = Image(frame_.width, frame_.height)};
            for (std::size_t i = 0; i < map.image.rgb.size(); ++i) {
                map.image.rgb[i] = search.factors.values[i / 3];
            }
            maps.push_back(std::move(map));
        }
        return maps;
    }

 private:
    // Sums over the passes, a plane for each candidate, and what was found.
    struct Search {
        Group group;
        std::vector<std::vector<double>> means{};    // Σ F_γ
        std::vector<std::vector<double>> moments{};  // Σ F_γ²
        Plane factors{};                             // empty: nothing was learned

        void add(std::span<const float> image, std::size_t n_candidates) {
            means.resize(n_candidates);
            moments.resize(n_candidates);
            const std::size_t n_pixels = image.size() / n_candidates;
            for (std::size_t c = 0; c < n_candidates; ++c) {
                means[c].resize(n_pixels);
                moments[c].resize(n_pixels);
                for (std::size_t i = 0; i < n_pixels; ++i) {
                    const double f = double{image[n_candidates * i + c]};
                    means[c][i] += f;
                    moments[c][i] += f * f;
                }
            }
        }
    };

    std::size_t n_pixels() const {
        return static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height);
    }

    // ---- Training.

    bool wants_weights() const override { return true; }
    // What the camera sees in the shade is a feature too.
    bool wants_zeros() const override { return parameters_.filter == "bilateral"; }
    void start_phase(std::size_t n_chunks) override { samples_->start_phase(n_chunks); }
    void finish_phase() override { samples_->finish_phase(); }

    void observe(const Sample& sample, std::size_t chunk) override {
        const std::size_t pixel = sample.path.pixel.index(frame_.width);
        const int n = sample.path.n_edges();
        if (!features_.empty() && n > 1 && sample.technique.kind != TechniqueKind::Light) {
            const SurfacePoint& point = sample.path.vertex(1).point;
            const double d2 = squared_length(point.position - sample.path.origin);
            features_[pixel] = {.normal = point.normal,
                                .distance = static_cast<float>(std::sqrt(d2))};
        }
        if (sample.weight == 0) return;
        const double value =
            sample.weight *
            (double{sample.value.r} + double{sample.value.g} + double{sample.value.b}) / 3;
        if (!std::isfinite(value)) return;
        for (std::size_t g = 0; g < searches_.size(); ++g) {
            const Group& group = searches_[g].group;
            if (!group.concerns(n)) continue;
            // F_γ, from the weights of this pass.                          [hua2025 Eq. 22]
            const bool in_group = sample.technique.kind == group.kind;
            double own = in_group ? 1 : 0;  // the group's part of the weights
            double others = 1 - own;
            if (!sample.weights.empty()) {
                own = others = 0;
                for (std::size_t t = 0; t < sample.weights.size(); ++t) {
                    const auto kind = technique_at(static_cast<int>(t), n).kind;
                    (kind == group.kind ? own : others) += sample.weights[t];
                }
            }
            std::array<float, kMaxCandidates> values;
            for (std::size_t c = 0; c < candidates_.size(); ++c) {
                values[c] = static_cast<float>(
                    value * corrected_weight_ratio(candidates_[c], in_group, own, others));
            }
            samples_->add(sample, chunk, static_cast<int>(g), pixel,
                          std::span(values).first(candidates_.size()));
        }
    }

    // [hua2025 section 4.2]
    void choose(Search& search, ThreadPool& threads) {
        if (search.means.empty()) return;
        const bool filters = parameters_.filter != "none";
        std::vector<Plane> means;
        std::vector<Plane> moments;
        for (std::size_t c = 0; c < candidates_.size(); ++c) {
            means.push_back(mean_of_passes(search.means[c]));
            moments.push_back(mean_of_passes(search.moments[c]));
            if (!filters) continue;
            filter(means[c], parameters_.blur_mean, threads);
            filter(moments[c], parameters_.blur, threads);
        }
        const std::size_t unchanged = candidates_.size() - 1;
        search.factors = Plane(frame_.width, frame_.height, 1);
        std::vector<double> relative(candidates_.size());
        for (std::size_t i = 0; i < n_pixels(); ++i) {
            for (std::size_t c = 0; c < candidates_.size(); ++c) {
                const bool own_mean = filters && parameters_.mean == "candidate";
                const double mean = double{means[own_mean ? c : unchanged].values[i]};
                const double moment = double{moments[c].values[i]};
                relative[c] = mean > 0 ? moment / (mean * mean) : kInfinity;
            }
            search.factors.values[i] =
                static_cast<float>(candidates_[best_candidate(relative, unchanged)]);
        }
        if (filters) filter(search.factors, parameters_.blur_factor, threads);
        search.means.clear();
        search.moments.clear();
    }
    Plane mean_of_passes(std::span<const double> sums) const {
        Plane mean(frame_.width, frame_.height);
        for (std::size_t i = 0; i < sums.size(); ++i) {
            mean.values[i] = static_cast<float>(sums[i] / static_cast<double>(n_passes_));
        }
        return mean;
    }
    void filter(Plane& plane, std::int64_t passes, ThreadPool& threads) const {
        if (parameters_.filter == "bilateral") {
            bilateral_filter(plane, static_cast<int>(passes), features_, threads);
        } else {
            box_filter(plane, 1, static_cast<int>(passes), threads);
        }
    }

    CorrectionParameters parameters_;
    std::vector<double> candidates_;
    FrameInfo frame_{};
    std::optional<PixelSums<float>> samples_;  // of the pass, by group; a channel a candidate
    std::vector<PixelFeature> features_;       // for the bilateral filter
    std::int64_t n_passes_ = 0;
    std::vector<Search> searches_;
};

}  // namespace

void CorrectionParameters::check() const {
    parse_groups(groups);
    parse_candidates(candidates);
    check_choice("correction_filter", filter, {"blur", "bilateral", "none"});
    check_choice("correction_mean", mean, {"candidate", "image"});
    constexpr std::int64_t kMaxPasses = 1024;
    check_range("correction_blur", blur, std::int64_t{0}, kMaxPasses);
    check_range("correction_blur_mean", blur_mean, std::int64_t{0}, kMaxPasses);
    check_range("correction_blur_factor", blur_factor, std::int64_t{0}, kMaxPasses);
}

std::shared_ptr<FactorProvider> make_correction(const CorrectionParameters& parameters) {
    return std::make_shared<Correction>(parameters);
}

}  // namespace misbench
