#include "experiments/analysis/findings.h"

#include <algorithm>
#include <map>

#include "renderer/base/check.h"

namespace misbench {
namespace {

// --- over several scenes -------------------------------------------------------------------------

Estimate to_certain_ratio(const LogRatio& ratio, double confidence) {
    if (!ratio.is_identity) return to_ratio(ratio, confidence);
    return {.value = 1, .interval = Interval{.low = 1, .high = 1}, .why_none = std::nullopt};
}

// The ratio that is furthest by `is_further`: the largest of all, or the smallest.
OverScenes extreme(std::span<const LogRatio> scenes, bool is_largest) {
    const auto is_further = [is_largest](double a, double b) { return is_largest ? a > b : a < b; };
    const double shared = 1 - (1 - kConfidence) / static_cast<double>(scenes.size());
    OverScenes result{.ratio = to_certain_ratio(scenes.front(), kConfidence), .scene = 0};
    std::optional<NoInterval> why_none;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        const Estimate alone = to_certain_ratio(scenes[s], kConfidence);
        const Estimate among = to_certain_ratio(scenes[s], shared);
        if (s == 0 || is_further(alone.value, result.ratio.value)) {
            result.ratio.value = alone.value;
            result.scene = s;
        }
        if (!among.interval) {
            why_none = among.why_none;
            continue;
        }
        if (why_none) continue;
        const Interval ends = is_largest ? Interval{among.interval->low, alone.interval->high}
                                         : Interval{alone.interval->low, among.interval->high};
        if (s == 0) result.ratio.interval = ends;
        auto& [low, high] = *result.ratio.interval;
        if (is_further(ends.low, low)) low = ends.low;
        if (is_further(ends.high, high)) high = ends.high;
    }
    if (why_none) result.ratio = {result.ratio.value, std::nullopt, why_none};
    return result;
}

// --- one claim -----------------------------------------------------------------------------------

// The cells of a claim in one scene.
struct ClaimedScene {
    std::string name;
    const ComparedCell* method = nullptr;
    const ComparedCell* against = nullptr;
};

ClaimedScene claimed_scene(const Claim& claim, const Comparison& comparison,
                           const std::string& name) {
    return {name, comparison.find(name, claim.method, claim.budget),
            comparison.find(name, claim.against, claim.budget)};
}

// The first cell that the plan does not have: images that have not been imported, or not yet.
std::string not_imported(const Claim& claim, const std::vector<ClaimedScene>& scenes) {
    for (const auto& [name, method, against] : scenes) {
        if (method != nullptr && against != nullptr) continue;
        return name + ", " + (method == nullptr ? claim.method : claim.against) +
               ": no images are imported";
    }
    return "";
}

Finding judge_ratio(const Claim& claim, const Estimate& ratio) {
    return ratio.interval ? judge(claim, *ratio.interval) : Finding::NotDecided;
}

std::optional<int> more_seeds_for(const Claim& claim, const std::vector<LogRatio>& ratios, int n) {
    if (n < kFewestForInterval) return kFewestForInterval - n;
    for (int wanted = n + 1; wanted <= kMostSeeds; wanted += std::max(1, wanted / 20)) {
        std::vector<LogRatio> then;
        for (const LogRatio& ratio : ratios) then.push_back(with_seeds(ratio, n, wanted));
        const Estimate ratio = combine(claim.over, then).ratio;
        if (judge_ratio(claim, ratio) != Finding::NotDecided) return wanted - n;
    }
    return std::nullopt;
}

// One line of a claim: of one scene where it is over each.
ClaimFinding judge_over(const Claim& claim, const std::vector<ClaimedScene>& scenes) {
    ClaimFinding found{.claim = claim,
                       .scene = claim.over == ClaimOver::Each ? scenes.front().name : "",
                       .ratio = std::nullopt,
                       .paper = std::nullopt,
                       .n_seeds = 0,
                       .reason = "",
                       .more_seeds = std::nullopt,
                       .is_paired = true};
    const auto paper = claim.paper.find(found.scene);
    if (paper != claim.paper.end()) found.paper = paper->second;
    found.reason = not_imported(claim, scenes);
    if (!found.reason.empty()) return found;
    found.n_seeds = scenes.front().method->n_measured;
    std::vector<LogRatio> ratios;
    std::string missing;
    for (const ClaimedScene& scene : scenes) {
        for (const ComparedCell* cell : {scene.method, scene.against}) {
            found.n_seeds = std::min(found.n_seeds, cell->n_measured);
            found.has_heavy_tail |= cell->has_heavy_tail();
            found.few_passes |= cell->few_passes;
            if (cell->is_complete() || !missing.empty()) continue;
            missing = scene.name + ", " + cell->method + ": " + status_of(*cell);
        }
        found.is_paired &= are_paired(*scene.method, *scene.against);
        if (const auto ratio = log_ratio(*scene.method, *scene.against)) ratios.push_back(*ratio);
    }
    const bool has_ratio = ratios.size() == scenes.size();
    if (has_ratio) {
        const OverScenes over = combine(claim.over, ratios);
        found.ratio = over.ratio;
        const bool is_extreme = claim.over == ClaimOver::Worst || claim.over == ClaimOver::Best;
        if (is_extreme) found.scene = scenes[over.scene].name;
    }
    if (!missing.empty()) {
        found.reason = missing;
        return found;
    }
    if (!has_ratio) {
        found.finding = Finding::NotDecided;
        found.reason = "a mean is not above zero";
        return found;
    }
    found.finding = judge_ratio(claim, *found.ratio);
    if (found.ratio->why_none) found.reason = to_string(*found.ratio->why_none);
    if (found.finding == Finding::NotReproduced && !excludes_one(*found.ratio)) {
        found.reason = "any difference is below the margin";
    }
    if (std::ranges::all_of(ratios, &LogRatio::is_identity)) {
        found.reason = "the same in every seed, bit by bit";
    }
    if (found.finding == Finding::NotDecided) {
        found.more_seeds = more_seeds_for(claim, ratios, found.n_seeds);
    }
    return found;
}

}  // namespace

std::string to_string(Finding finding) {
    switch (finding) {
        case Finding::Reproduced:
            return "reproduced";
        case Finding::NotReproduced:
            return "not reproduced";
        case Finding::NotDecided:
            return "not decided";
        case Finding::NotMeasured:
            break;
    }
    return "not measured";
}

Finding judge(const Claim& claim, const Interval& ratio) {
    const double most = 1 + claim.margin;
    const double least = 1 / most;
    bool holds = false;
    bool fails = false;
    switch (claim.expect) {
        case Expectation::Less:
            holds = ratio.high < 1;
            fails = ratio.low > least;
            break;
        case Expectation::More:
            holds = ratio.low > 1;
            fails = ratio.high < most;
            break;
        case Expectation::NotMore:
            holds = ratio.high < most;
            fails = ratio.low > most;
            break;
        case Expectation::NotLess:
            holds = ratio.low > least;
            fails = ratio.high < least;
            break;
        case Expectation::Equal:
            holds = ratio.low > least && ratio.high < most;
            fails = ratio.high < least || ratio.low > most;
            break;
    }
    if (holds) return Finding::Reproduced;
    return fails ? Finding::NotReproduced : Finding::NotDecided;
}

OverScenes combine(ClaimOver over, std::span<const LogRatio> scenes) {
    switch (over) {
        case ClaimOver::Mean:
            return {.ratio = to_certain_ratio(mean_log_ratio(scenes), kConfidence)};
        case ClaimOver::Worst:
            return extreme(scenes, true);
        case ClaimOver::Best:
            return extreme(scenes, false);
        case ClaimOver::Each:
            break;
    }
    MISBENCH_CHECK(scenes.size() == 1);
    return {.ratio = to_certain_ratio(scenes.front(), kConfidence)};
}

std::optional<bool> ClaimFinding::agrees_with_paper() const {
    if (!paper || !ratio || !ratio->interval) return std::nullopt;
    return ratio->interval->low <= *paper && *paper <= ratio->interval->high;
}

std::vector<ClaimFinding> judge_claims(const Store& store, const Plan& plan) {
    std::map<std::string, Comparison> comparisons;  // by metric
    std::vector<ClaimFinding> findings;
    for (const Claim& claim : plan.claims) {
        if (!comparisons.contains(claim.metric)) {
            comparisons.emplace(claim.metric, compare(store, plan, claim.metric));
        }
        const Comparison& comparison = comparisons.at(claim.metric);
        std::vector<ClaimedScene> scenes;
        for (const std::string& name : claim.scenes) {
            scenes.push_back(claimed_scene(claim, comparison, name));
        }
        if (claim.over != ClaimOver::Each) {
            findings.push_back(judge_over(claim, scenes));
            continue;
        }
        for (const ClaimedScene& scene : scenes) findings.push_back(judge_over(claim, {scene}));
    }
    return findings;
}

}  // namespace misbench
