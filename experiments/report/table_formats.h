// A table in the formats people read or paste, and a comparison in those that programs read.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "experiments/report/table.h"

namespace misbench {

std::string escape_html(std::string_view text);
std::string escape_latex(std::string_view text);
std::string escape_csv(std::string_view text);
std::string escape_markdown(std::string_view text);  // of a table's cell

std::string to_text(const Table& table);      // aligned columns for a terminal
std::string to_markdown(const Table& table);  // a GitHub table, footer below
std::string to_latex(const Table& table);     // a tabular with booktabs' rules, footer as comments
std::string to_html(const Table& table);      // a table element and its footer

// One row per scene, method and budget, all numbers in full precision; empty where there is none.
std::string to_csv(std::span<const Comparison> comparisons);
// An object; a list of them for several.
std::string to_json(std::span<const Comparison> comparisons);

// One \\newcommand for each number of the table, with its digits, so that prose need not copy:
// \\<Experiment><Metric><Scene><Method><Budget>Mean, …MeanLow, …MeanHigh, …Ratio, …RatioLow,
// …RatioHigh, of letters only. Names that would be the same get five further letters that follow
// from what they stand for, so that no name depends on what else is in the table's order.
std::string to_latex_macros(std::span<const Comparison> comparisons, std::optional<int> digits);

}  // namespace misbench
