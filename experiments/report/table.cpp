#include "experiments/report/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "experiments/analysis/seed_rounds.h"
#include "experiments/report/numbers.h"
#include "experiments/report/pivot.h"
#include "renderer/base/error.h"
#include "renderer/base/render_statistics.h"

namespace misbench {
namespace {

constexpr const char* kLessMark = " ▼*";
constexpr const char* kMoreMark = " ▲*";
constexpr const char* kFewPassesMark = " †";
constexpr const char* kHeavyTailMark = " ‡";
constexpr const char* kNoisyReferenceMark = " §";

// Which footnotes the cells of a table need.
struct Footnotes {
    bool few_passes = false;
    bool heavy_tail = false;
    bool noisy_reference = false;
    bool paired = false;  // a ratio is one of pairs
    bool unpaired = false;
    bool means_of_scenes = false;
    std::vector<NoInterval> reasons;  // the letters a, b, … stand for

    std::string mark(NoInterval reason) {
        const auto found = std::ranges::find(reasons, reason);
        const auto i = found - reasons.begin();
        if (found == reasons.end()) reasons.push_back(reason);
        return std::string(" ") + letter(static_cast<std::size_t>(i));
    }
    static char letter(std::size_t i) { return static_cast<char>('a' + static_cast<int>(i)); }
};

Verdict verdict_of(const Comparison& comparison, const ComparedCell& cell) {
    if (!cell.differs()) return Verdict::None;
    if (comparison.better == Direction::None) return Verdict::Different;
    return (cell.ratio->value < 1) == (comparison.better == Direction::Less) ? Verdict::Better
                                                                             : Verdict::Worse;
}

void lay_out_ratio(TableCell& text, const Comparison& comparison, const ComparedCell& cell,
                   const TableLayout& layout, Footnotes& notes) {
    if (comparison.baseline == kToNone || layout.hidden.contains("ratio")) return;
    text.ratio = cell.is_baseline ? "baseline" : "–";
    if (!cell.ratio) return;
    text.verdict = verdict_of(comparison, cell);
    text.ratio = format_ratio(*cell.ratio, layout.digits);
    (cell.is_mean_of_scenes ? notes.means_of_scenes
     : cell.ratio_is_paired ? notes.paired
                            : notes.unpaired) = true;
    if (cell.ratio->why_none) text.ratio += notes.mark(*cell.ratio->why_none);
    if (text.verdict != Verdict::None) {
        text.ratio += cell.ratio->value < 1 ? kLessMark : kMoreMark;
    }
}

void lay_out_mean(TableCell& text, const ComparedCell& cell, const TableLayout& layout,
                  Footnotes& notes) {
    if (layout.hidden.contains("mean")) return;
    text.mean = format_mean(*cell.mean, layout.digits);
    if (cell.mean->why_none) text.mean += notes.mark(*cell.mean->why_none);
    if (cell.few_passes) text.mean += kFewPassesMark;
    if (cell.has_heavy_tail()) text.mean += kHeavyTailMark;
    if (cell.has_noisy_reference()) text.mean += kNoisyReferenceMark;
    notes.few_passes |= cell.few_passes;
    notes.heavy_tail |= cell.has_heavy_tail();
    notes.noisy_reference |= cell.has_noisy_reference();
}

std::string effort_of(const ComparedCell& cell) {
    const auto* time = std::get_if<TimeBudget>(&cell.budget);
    const bool is_wall = time != nullptr && time->clock == BudgetClock::Wall;
    const double seconds = is_wall ? cell.mean_wall_seconds : cell.mean_cpu_seconds;
    // Of images of other renderers one of the two may not be known.
    std::string effort;
    if (cell.mean_passes > 0) effort = fmt::format("about {:.0f} spp", cell.mean_passes);
    if (seconds > 0) {
        effort += fmt::format("{}in {:.3g} s {}", effort.empty() ? "" : " ", seconds,
                              is_wall ? "wall" : "cpu");
    }
    return effort;
}

TableCell lay_out_cell(const Comparison& comparison, const ComparedCell& cell,
                       const TableLayout& layout, Footnotes& notes) {
    TableCell text;
    if (!layout.hidden.contains("seeds")) text.status = status_of(cell);
    const bool is_shown = !layout.hidden.contains("mean");
    if (!cell.mean && cell.n_measured > 0 && is_shown) text.mean = "–";
    if (cell.mean) {
        text.number = cell.mean->value;
        lay_out_mean(text, cell, layout, notes);
        if (!layout.hidden.contains("effort")) text.effort = effort_of(cell);
    }
    if (cell.ratio && (!text.number || !is_shown)) {
        text.number = cell.ratio->value;
    }
    if (cell.mean || cell.is_mean_of_scenes) lay_out_ratio(text, comparison, cell, layout, notes);
    return text;
}

// The least and the largest number of seeds of a cell.
std::pair<int, int> seeds_of(std::span<const Comparison> comparisons) {
    int fewest = 0;
    int most = 0;
    for (const Comparison& comparison : comparisons) {
        for (const ComparedCell& cell : comparison.cells) {
            if (cell.is_mean_of_scenes) continue;
            fewest = fewest == 0 ? cell.n_planned : std::min(fewest, cell.n_planned);
            most = std::max(most, cell.n_planned);
        }
    }
    return {fewest, most};
}

int n_tests_of(std::span<const Comparison> comparisons) {
    std::ptrdiff_t n = 0;
    for (const Comparison& comparison : comparisons) {
        n += std::ranges::count_if(comparison.cells,
                                   [](const auto& cell) { return cell.adjusted_p.has_value(); });
    }
    return static_cast<int>(n);
}

std::string metric_line(const Comparison& comparison) {
    return fmt::format("metric: {}, {}{}", comparison.metric, comparison.formula,
                       comparison.better == Direction::None
                           ? ""
                           : "; " + to_string(comparison.better) + " is better");
}

std::string ratio_line(const std::string& baseline, const Footnotes& notes, int percent) {
    const std::string to =
        baseline == kToBest
            ? "the best of its scene and budget, by the same runs: a ranking, not a test"
            : "baseline '" + baseline + "'";
    return fmt::format("× ratio of means to {} [{} % log-delta-t interval, {}]", to, percent,
                       kind_of_interval(notes.paired, notes.unpaired));
}

std::string scene_means_line() {
    return fmt::format(
        "geometric means of ratios: of these scenes [from the spread of the seeds], of scenes like "
        "these [bootstrap-t over scenes, of {} or more; no test]",
        kFewestToResample);
}

bool is_efficiency(const Comparison& comparison) { return comparison.metric.starts_with("1/("); }
bool is_tail(const Comparison& comparison) { return comparison.metric.starts_with("tail("); }

std::vector<std::string> footer_of(std::span<const Comparison> comparisons, const Footnotes& notes,
                                   const TableLayout& layout) {
    const auto percent = static_cast<int>(100 * kConfidence + 0.5);
    const auto [fewest, most] = seeds_of(comparisons);
    std::vector<std::string> footer;
    const auto add = [&footer](const std::string& line) {
        if (std::ranges::find(footer, line) == footer.end()) footer.push_back(line);
    };
    for (const Comparison& comparison : comparisons) add(metric_line(comparison));
    const bool has_means = !std::ranges::all_of(comparisons, is_tail);
    if (!layout.hidden.contains("mean") && has_means) {
        const bool is_mixed = std::ranges::any_of(comparisons, is_efficiency);
        add(fmt::format("mean over {} ± half of its {} % Student t interval{}",
                        fewest == most ? fmt::format("{} seed{}", most, most == 1 ? "" : "s")
                                       : fmt::format("{} to {} seeds", fewest, most),
                        percent, is_mixed ? "; of 1/(…) the reciprocals of both ends" : ""));
    }
    const bool is_of_many = std::ranges::any_of(comparisons, [&](const Comparison& comparison) {
        return comparison.experiment != comparisons.front().experiment;
    });
    for (const Comparison& comparison : comparisons) {
        if (!comparison.seed_rule) continue;
        add((is_of_many ? comparison.experiment + ", " : "") + seed_rule_footnote(comparison));
    }
    const int n_tests = layout.hidden.contains("ratio") ? 0 : n_tests_of(comparisons);
    for (const Comparison& comparison : comparisons) {
        if (comparison.baseline == kToNone || layout.hidden.contains("ratio")) continue;
        add(ratio_line(comparison.baseline, notes, percent) +
            (fewest < most && notes.paired ? ", of the seeds that both have" : ""));
    }
    if (notes.means_of_scenes) add(scene_means_line());
    if (n_tests > 0) {
        add(
            fmt::format("▼* ▲* the ratio is not 1: p ≤ {:.2g}, adjusted for all {} ratios of the "
                        "table (Benjamini-Hochberg)",
                        1 - kConfidence, n_tests));
    }
    if (notes.few_passes) add(few_passes_footnote());
    if (notes.heavy_tail) add(heavy_tail_footnote());
    if (notes.noisy_reference) add(noisy_reference_footnote());
    for (std::size_t i = 0; i < notes.reasons.size(); ++i) {
        add(fmt::format("{} no interval: {}", Footnotes::letter(i), to_string(notes.reasons[i])));
    }
    return footer;
}

std::string title_of(std::span<const Comparison> comparisons) {
    std::vector<std::string> experiments;
    std::vector<std::string> metrics;
    std::vector<std::string> budgets;
    const auto add = [](std::vector<std::string>& list, const std::string& text) {
        if (std::ranges::find(list, text) == list.end()) list.push_back(text);
    };
    for (const Comparison& comparison : comparisons) {
        add(experiments, comparison.experiment);
        add(metrics, comparison.metric);
        for (const Budget& budget : comparison.budgets) add(budgets, to_string(budget));
    }
    std::string title =
        fmt::format("{}: {}", fmt::join(experiments, ", "), fmt::join(metrics, ", "));
    if (budgets.size() == 1) title += ", " + budgets.front();
    return title;
}

// Rows without a number come last, means over scenes behind them.
void sort_rows(Table& table, const std::string& by) {
    if (by.empty()) return;
    const auto column = std::ranges::find(table.columns, by);
    if (by != "name" && by != "mean" && column == table.columns.end()) {
        throw Error(Errc::InvalidArgument,
                    fmt::format("sort rows: unknown column '{}'; known: name mean {}", by,
                                fmt::join(table.columns, " ")));
    }
    const auto number_of = [&](const TableRow& row) {
        if (column != table.columns.end()) {
            return row.cells[static_cast<std::size_t>(column - table.columns.begin())].number;
        }
        double sum = 0;
        int n = 0;
        for (const TableCell& cell : row.cells) {
            sum += cell.number.value_or(0);
            n += cell.number ? 1 : 0;
        }
        return n == 0 ? std::nullopt : std::optional(sum / n);
    };
    std::ranges::stable_sort(table.rows, [&](const TableRow& a, const TableRow& b) {
        if (a.is_mean_of_scenes != b.is_mean_of_scenes) return b.is_mean_of_scenes;
        if (by == "name") return a.labels < b.labels;
        const auto left = number_of(a);
        const auto right = number_of(b);
        if (left.has_value() != right.has_value()) return left.has_value();
        return left && *left < *right;
    });
}

}  // namespace

std::string kind_of_interval(bool some_paired, bool some_unpaired) {
    if (!some_paired) return "Welch";
    return some_unpaired ? "paired by seed, or Welch where seeds differ" : "paired by seed";
}

std::string few_passes_footnote() {
    return fmt::format("† a run has fewer than {} passes: the discarded pass biases its error",
                       kFewPasses);
}

std::string heavy_tail_footnote() {
    return fmt::format(
        "‡ the largest seed is more than {} × the median one: rare samples carry the error, "
        "intervals may be too short",
        kHeavyTail);
}

std::string noisy_reference_footnote() {
    return fmt::format(
        "§ more than {:g} % of the error is the reference's own noise: `misbench reference STORE "
        "--improve 4` renders a better one",
        100 * kNoisyReference);
}

Table make_table(std::span<const Comparison> comparisons, const TableLayout& layout,
                 const std::vector<std::string>& provenance) {
    const Pivot pivoted = pivot(comparisons, layout.rows, layout.columns);
    Table table;
    table.title = title_of(comparisons);
    table.label_headers = pivoted.row_axes;
    table.columns = pivoted.columns;
    Footnotes notes;
    for (const Pivot::Row& from : pivoted.rows) {
        TableRow& row = table.rows.emplace_back();
        row.labels = from.labels;
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
            const auto found = from.cells.find(c);
            if (found == from.cells.end()) {
                row.cells.emplace_back().mean = "–";
                continue;
            }
            const auto& [comparison, cell] = found->second;
            row.cells.push_back(lay_out_cell(*comparison, *cell, layout, notes));
            row.is_mean_of_scenes |= cell->is_mean_of_scenes && layout.columns != "scene";
        }
    }
    sort_rows(table, layout.sort);
    if (layout.hidden.contains("footer")) return table;
    table.footer = footer_of(comparisons, notes, layout);
    table.footer.insert(table.footer.end(), provenance.begin(), provenance.end());
    return table;
}

Table make_table(const Comparison& comparison, const TableLayout& layout,
                 const std::vector<std::string>& provenance) {
    return make_table(std::span(&comparison, 1), layout, provenance);
}

}  // namespace misbench
