// A comparison laid out as a table of text, one step before a format. Scenes, methods and budgets
// go down, across, and (the third) as further rows.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"

namespace misbench {

enum class Axis { Scenes, Methods, Budgets };
std::string to_string(Axis axis);
Axis axis_from_string(const std::string& text);  // throws InvalidArgument

struct TableLayout {
    Axis rows = Axis::Scenes;
    Axis columns = Axis::Methods;
};

// What a ratio whose interval excludes 1 says about the method.
enum class Verdict { None, Better, Worse, Different };

struct TableCell {
    std::string mean;    // "0.0123 ± 0.0011 †"
    std::string ratio;   // "×0.54 [0.50, 0.58] *", "baseline", or ""
    std::string status;  // "4 of 5 seeds: 1 failed"; "" when all seeds are in the numbers
    std::string effort;  // "about 120 spp in 0.51 s"
    Verdict verdict = Verdict::None;
};

struct TableRow {
    std::vector<std::string> labels;
    std::vector<TableCell> cells;
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

// What the marks † and ‡ of a doubtful number mean, as lines of a footer.
std::string few_passes_footnote();
std::string heavy_tail_footnote();

// `provenance` ends the footer. Throws InvalidArgument when rows and columns are the same axis.
Table make_table(const Comparison& comparison, const TableLayout& layout,
                 const std::vector<std::string>& provenance);

}  // namespace misbench
