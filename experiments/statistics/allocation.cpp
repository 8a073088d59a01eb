#include "experiments/statistics/allocation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// A round's share of the time that the wide ratios' seeds took so far.
constexpr double kRoundShare = 0.5;
// What a seed costs at least: clocks may say zero.
constexpr double kLeastSeconds = 1e-6;

// The most that a round gives: until the ratio is narrow by its present variance.
int most_of_round(const RenderedRatio& rendered, double halfwidth) {
    const int most = std::max(rendered.n, std::min(2 * rendered.n, rendered.most_seeds));
    if (!rendered.ratio) return most;
    // The fewest that make it narrow, by bisection: more pairs make no interval wider.
    int low = rendered.n;
    int high = most;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        const LogRatio then = with_seeds(*rendered.ratio, rendered.n, middle);
        if (is_narrow(then, halfwidth)) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

// Of one pair. Where there is no ratio yet nothing is known, which comes first.
double variance_of_pair(const RenderedRatio& rendered) {
    return rendered.ratio ? rendered.ratio->variance * rendered.n
                          : std::numeric_limits<double>::infinity();
}

// One round, seed by seed.
class Round {
 public:
    Round(std::span<const RenderedBaseline> baselines, std::span<const RenderedRatio> ratios,
          double halfwidth)
        : baselines_(baselines), ratios_(ratios) {
        for (const RenderedBaseline& baseline : baselines) n_baseline_.push_back(baseline.n);
        for (const RenderedRatio& rendered : ratios) {
            MISBENCH_CHECK(rendered.n <= baselines[rendered.baseline].n);
            n_.push_back(rendered.n);
            most_.push_back(most_of_round(rendered, halfwidth));
        }
    }

    std::vector<int> seeds() && {
        double seconds_left = kRoundShare * seconds_so_far();
        while (seconds_left > 0) {
            const std::optional<std::size_t> next = most_useful();
            if (!next) break;
            seconds_left -= seconds_of_next(*next);
            int& n_baseline = n_baseline_[ratios_[*next].baseline];
            n_baseline = std::max(n_baseline, ++n_[*next]);
        }
        return std::move(n_);
    }

 private:
    bool is_open(std::size_t r) const { return n_[r] < most_[r]; }

    // Of the seeds of the open ratios, a baseline's once.
    double seconds_so_far() const {
        double seconds = 0;
        std::vector<bool> is_counted(baselines_.size());
        for (std::size_t r = 0; r < ratios_.size(); ++r) {
            if (!is_open(r)) continue;
            const RenderedRatio& rendered = ratios_[r];
            const RenderedBaseline& baseline = baselines_[rendered.baseline];
            seconds += rendered.n * std::max(rendered.seconds, kLeastSeconds);
            if (!is_counted[rendered.baseline]) {
                seconds += baseline.n * std::max(baseline.seconds, kLeastSeconds);
            }
            is_counted[rendered.baseline] = true;
        }
        return seconds;
    }

    double seconds_of_next(std::size_t r) const {
        const std::size_t b = ratios_[r].baseline;
        const double seconds = std::max(ratios_[r].seconds, kLeastSeconds);
        const bool is_baseline_there = n_[r] < n_baseline_[b];
        return is_baseline_there ? seconds
                                 : seconds + std::max(baselines_[b].seconds, kLeastSeconds);
    }

    // The first of equals.
    std::optional<std::size_t> most_useful() const {
        std::optional<std::size_t> best;
        double best_rate = 0;
        for (std::size_t r = 0; r < ratios_.size(); ++r) {
            if (!is_open(r)) continue;
            const double n = n_[r];
            const double rate = variance_of_pair(ratios_[r]) / (n * (n + 1) * seconds_of_next(r));
            if (best && !(rate > best_rate)) continue;
            best = r;
            best_rate = rate;
        }
        return best;
    }

    std::span<const RenderedBaseline> baselines_;
    std::span<const RenderedRatio> ratios_;
    std::vector<int> n_baseline_;
    std::vector<int> n_;
    std::vector<int> most_;
};

}  // namespace

bool is_narrow(const std::optional<LogRatio>& ratio, double halfwidth) {
    if (!ratio) return false;
    if (ratio->why_none) return *ratio->why_none == NoInterval::NoSpread;
    const std::optional<Interval> interval = to_ratio(*ratio).interval;
    return interval && std::log(interval->high) - ratio->value <= std::log1p(halfwidth);
}

std::vector<int> allocate(std::span<const RenderedBaseline> baselines,
                          std::span<const RenderedRatio> ratios, double halfwidth) {
    return Round(baselines, ratios, halfwidth).seeds();
}

}  // namespace misbench
