#include "experiments/cli/run_lookup.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "renderer/base/error.h"

namespace misbench {
namespace {

constexpr std::size_t kMaxNamedRuns = 5;

// How many characters both begin with.
std::size_t common_beginning(const std::string& a, const std::string& b) {
    return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

std::string find_id(const std::set<std::string>& ids, const std::string& beginning,
                    const Store& store) {
    std::vector<std::string> nearest;
    std::size_t longest = 0;
    for (const std::string& id : ids) {
        const std::size_t common = common_beginning(id, beginning);
        if (common > longest) nearest.clear();
        longest = std::max(longest, common);
        if (common == longest) nearest.push_back(id);
    }
    const bool is_known = longest == beginning.size();
    if (is_known && nearest.size() == 1) return nearest[0];
    std::string message =
        fmt::format("{} run '{}' in store '{}'", is_known ? "ambiguous" : "unknown", beginning,
                    store.folder().string());
    if (nearest.empty()) throw Error(Errc::InvalidArgument, message + ": it has no runs");
    message += "; near:";
    for (std::size_t i = 0; i < std::min(nearest.size(), kMaxNamedRuns); ++i) {
        message += " " + nearest[i];
    }
    if (nearest.size() > kMaxNamedRuns) {
        message += fmt::format(" and {} more", nearest.size() - kMaxNamedRuns);
    }
    throw Error(Errc::InvalidArgument, message);
}

std::set<std::string> run_ids(const Store& store) {
    std::set<std::string> ids;
    for (const auto& [id, summary] : store.run_summaries()) ids.insert(id);
    return ids;
}

}  // namespace

std::string find_run(const Store& store, const std::string& beginning) {
    return find_id(run_ids(store), beginning, store);
}

std::string find_run_or_task(const Store& store, const std::string& beginning) {
    std::set<std::string> ids = run_ids(store);
    for (const TaskRow& row : store.tasks()) ids.insert(row.id);
    return find_id(ids, beginning, store);
}

}  // namespace misbench
