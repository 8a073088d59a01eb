#include "experiments/report/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "experiments/report/numbers.h"
#include "renderer/base/error.h"
#include "renderer/base/render_statistics.h"

namespace misbench {
namespace {

constexpr std::array kAxes{Axis::Scenes, Axis::Methods, Axis::Budgets};
constexpr const char* kDifferentMark = " *";
constexpr const char* kFewPassesMark = " †";
constexpr const char* kHeavyTailMark = " ‡";

// Which footnotes the cells of a table need.
struct Footnotes {
    bool few_passes = false;
    bool heavy_tail = false;
    bool paired = false;  // a ratio is one of pairs
    bool unpaired = false;
    std::map<NoInterval, char> reasons;  // to the letter that stands for each

    std::string mark(NoInterval reason) {
        const auto letter = static_cast<char>('a' + static_cast<int>(reasons.size()));
        return std::string(" ") + reasons.try_emplace(reason, letter).first->second;
    }
};

Axis third_axis(const TableLayout& layout) {
    const auto is_free = [&layout](Axis axis) {
        return axis != layout.rows && axis != layout.columns;
    };
    return *std::ranges::find_if(kAxes, is_free);
}

std::vector<std::string> values_of(const Comparison& comparison, Axis axis) {
    if (axis == Axis::Scenes) return comparison.scenes;
    if (axis == Axis::Methods) return comparison.methods;
    std::vector<std::string> budgets;
    for (const Budget& budget : comparison.budgets) budgets.push_back(to_string(budget));
    return budgets;
}

const ComparedCell* find_cell(const Comparison& comparison,
                              const std::map<Axis, std::size_t>& place) {
    return comparison.find(comparison.scenes[place.at(Axis::Scenes)],
                           comparison.methods[place.at(Axis::Methods)],
                           comparison.budgets[place.at(Axis::Budgets)]);
}

Verdict verdict_of(const Comparison& comparison, const ComparedCell& cell) {
    if (!cell.ratio_excludes_one()) return Verdict::None;
    if (comparison.better == Direction::None) return Verdict::Different;
    return (cell.ratio->value < 1) == (comparison.better == Direction::Less) ? Verdict::Better
                                                                             : Verdict::Worse;
}

TableCell lay_out_cell(const Comparison& comparison, const ComparedCell* cell, Footnotes& notes) {
    TableCell text;
    if (cell == nullptr) {
        text.mean = "–";
        return text;
    }
    text.status = status_of(*cell);
    text.verdict = verdict_of(comparison, *cell);
    if (!cell->mean) return text;
    text.mean = format_mean(*cell->mean);
    if (cell->mean->why_none) text.mean += notes.mark(*cell->mean->why_none);
    if (cell->few_passes) text.mean += kFewPassesMark;
    if (cell->has_heavy_tail()) text.mean += kHeavyTailMark;
    notes.few_passes |= cell->few_passes;
    notes.heavy_tail |= cell->has_heavy_tail();
    text.ratio = cell->is_baseline ? "baseline" : "–";
    if (cell->ratio) {
        text.ratio = format_ratio(*cell->ratio);
        (cell->ratio_is_paired ? notes.paired : notes.unpaired) = true;
        if (cell->ratio->why_none) text.ratio += notes.mark(*cell->ratio->why_none);
        if (text.verdict != Verdict::None) text.ratio += kDifferentMark;
    }
    const auto* time = std::get_if<TimeBudget>(&cell->budget);
    const bool is_wall = time != nullptr && time->clock == BudgetClock::Wall;
    const double seconds = is_wall ? cell->mean_wall_seconds : cell->mean_cpu_seconds;
    // Of images of other renderers one of the two may not be known.
    if (cell->mean_passes > 0) text.effort = fmt::format("about {:.0f} spp", cell->mean_passes);
    if (seconds > 0) {
        text.effort += fmt::format("{}in {:.3g} s {}", text.effort.empty() ? "" : " ", seconds,
                                   is_wall ? "wall" : "cpu");
    }
    return text;
}

std::string seeds_of(const Comparison& comparison) {
    int fewest = 0;
    int most = 0;
    for (const ComparedCell& cell : comparison.cells) {
        fewest = fewest == 0 ? cell.n_planned : std::min(fewest, cell.n_planned);
        most = std::max(most, cell.n_planned);
    }
    if (fewest == most) return fmt::format("{} seed{}", most, most == 1 ? "" : "s");
    return fmt::format("{} to {} seeds", fewest, most);
}

std::vector<std::string> footer_of(const Comparison& comparison, const Footnotes& notes) {
    const auto percent = static_cast<int>(100 * kConfidence + 0.5);
    std::vector<std::string> footer{
        fmt::format("metric: {}, {}{}", comparison.metric, comparison.formula,
                    comparison.better == Direction::None
                        ? ""
                        : "; " + to_string(comparison.better) + " is better"),
        fmt::format("mean over {} ± half of its {} % Student t interval", seeds_of(comparison),
                    percent),
        fmt::format("× ratio of means to baseline '{}' [{} % log-delta-t interval, {}]",
                    comparison.baseline, percent, kind_of_interval(notes.paired, notes.unpaired)),
        "* the interval of the ratio excludes 1"};
    if (notes.few_passes) footer.push_back(few_passes_footnote());
    if (notes.heavy_tail) footer.push_back(heavy_tail_footnote());
    for (const auto& [reason, letter] : notes.reasons) {
        footer.push_back(fmt::format("{} no interval: {}", letter, to_string(reason)));
    }
    return footer;
}

// No row for what the experiment excludes altogether.
bool is_empty(const std::vector<const ComparedCell*>& cells) {
    return std::ranges::all_of(cells, [](const ComparedCell* cell) { return cell == nullptr; });
}

}  // namespace

std::string to_string(Axis axis) {
    switch (axis) {
        case Axis::Scenes:
            return "scene";
        case Axis::Methods:
            return "method";
        case Axis::Budgets:
            break;
    }
    return "budget";
}

Axis axis_from_string(const std::string& text) {
    for (const Axis axis : kAxes) {
        if (to_string(axis) == text) return axis;
    }
    throw Error(Errc::InvalidArgument, "unknown axis '" + text + "'; known: scene method budget");
}

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

Table make_table(const Comparison& comparison, const TableLayout& layout,
                 const std::vector<std::string>& provenance) {
    if (layout.rows == layout.columns) {
        throw Error(Errc::InvalidArgument,
                    "lay out table: rows and columns are both '" + to_string(layout.rows) + "'");
    }
    const Axis further = third_axis(layout);
    const std::vector<std::string> rows = values_of(comparison, layout.rows);
    const std::vector<std::string> columns = values_of(comparison, layout.columns);
    const std::vector<std::string> further_rows = values_of(comparison, further);
    const bool names_further = further_rows.size() > 1;

    Table table;
    table.title = comparison.experiment + ": " + comparison.metric;
    if (!names_further && !further_rows.empty()) table.title += ", " + further_rows.front();
    table.label_headers = {to_string(layout.rows)};
    if (names_further) table.label_headers.push_back(to_string(further));
    table.columns = columns;

    Footnotes notes;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t f = 0; f < further_rows.size(); ++f) {
            std::vector<const ComparedCell*> cells;
            for (std::size_t c = 0; c < columns.size(); ++c) {
                cells.push_back(
                    find_cell(comparison, {{layout.rows, r}, {layout.columns, c}, {further, f}}));
            }
            if (is_empty(cells)) continue;
            TableRow& row = table.rows.emplace_back();
            row.labels = {rows[r]};
            if (names_further) row.labels.push_back(further_rows[f]);
            for (const ComparedCell* cell : cells) {
                row.cells.push_back(lay_out_cell(comparison, cell, notes));
            }
        }
    }
    table.footer = footer_of(comparison, notes);
    table.footer.insert(table.footer.end(), provenance.begin(), provenance.end());
    return table;
}

}  // namespace misbench
