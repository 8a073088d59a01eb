// The cells of comparisons by the values that they have along axes.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "experiments/analysis/comparison.h"

namespace misbench {

struct PivotCell {
    const Comparison* comparison = nullptr;
    const ComparedCell* cell = nullptr;
};

// Where a row, column and cell are along the axes; texts, as the table shows them.
struct Pivot {
    std::vector<std::string> row_axes;  // the one asked for, then those that tell cells apart
    std::vector<std::string> columns;
    // By the places of the row's labels on their axes, then by column.
    struct Row {
        std::vector<std::string> labels;
        std::map<std::size_t, PivotCell> cells;
    };
    std::vector<Row> rows;
};

// The value of a cell along an axis; "–" for a parameter that its method does not have.
std::string value_along(const PivotCell& cell, const std::string& axis);

// Throws InvalidArgument for an unknown axis, with the known ones.
Pivot pivot(std::span<const Comparison> comparisons, const std::string& rows,
            const std::string& columns);

}  // namespace misbench
