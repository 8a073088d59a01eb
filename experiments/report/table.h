// Comparisons laid out as a table of text, one step before a format: any axis down, any across, and
// as further rows the axes without which two numbers would fall into one cell.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"

namespace misbench {

struct TableLayout {
    // "scene", "method", "budget", "metric", "experiment", or a parameter's name.
    std::string rows = "scene";
    std::string columns = "method";
    std::string sort;              // "" as in the plan, "name", "mean" of the row, or a column
    std::set<std::string> hidden;  // of kHideable
    std::optional<int> digits;     // significant ones of numbers; absent: as the interval supports
};
inline constexpr const char* kHideable[] = {"mean", "ratio", "seeds", "effort", "footer"};

// What a ratio that differs from 1, also among the many of the table, says about the method.
enum class Verdict { None, Better, Worse, Different };

struct TableCell {
    std::string mean;    // "0.0123 ± 0.0011 †"
    std::string ratio;   // "×0.54 [0.50, 0.58] ▼*", "baseline", or ""
    std::string status;  // "4 of 5 seeds: 1 failed"; "" when all seeds are in the numbers
    std::string effort;  // "about 120 spp in 0.51 s"
    Verdict verdict = Verdict::None;
    std::optional<double> number;  // to sort by: the mean, or the ratio where there is none
};

struct TableRow {
    std::vector<std::string> labels;
    std::vector<TableCell> cells;
    bool is_mean_of_scenes = false;
};

struct Table {
    std::string title;
    std::vector<std::string> label_headers;
    std::vector<std::string> columns;
    std::vector<TableRow> rows;
    std::vector<std::string> footer;  // one line each
};

// How the intervals of ratios are taken, of which some are of pairs and some are not.
std::string kind_of_interval(bool some_paired, bool some_unpaired);

// What the marks †, ‡ and § of a doubtful number mean, as lines of a footer.
std::string few_passes_footnote();
std::string heavy_tail_footnote();
std::string noisy_reference_footnote();

// `provenance` ends the footer. Throws InvalidArgument when rows and columns are the same axis or
// one of them is unknown.
Table make_table(std::span<const Comparison> comparisons, const TableLayout& layout,
                 const std::vector<std::string>& provenance);
Table make_table(const Comparison& comparison, const TableLayout& layout,
                 const std::vector<std::string>& provenance);

}  // namespace misbench
