#include "experiments/report/pivot.h"

#include <algorithm>
#include <array>
#include <set>

#include "renderer/base/error.h"

namespace misbench {
namespace {

constexpr std::array kFixedAxes{"scene", "method", "budget", "metric", "experiment"};

bool is_fixed(const std::string& axis) {
    return std::ranges::find(kFixedAxes, axis) != kFixedAxes.end();
}

std::vector<PivotCell> all_cells(std::span<const Comparison> comparisons) {
    std::vector<PivotCell> cells;
    for (const Comparison& comparison : comparisons) {
        for (const ComparedCell& cell : comparison.cells) cells.push_back({&comparison, &cell});
    }
    return cells;
}

void add_new(std::vector<std::string>& values, const std::string& value) {
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
}

bool is_before(const ParameterValue& a, const ParameterValue& b) {
    const auto number = [](const ParameterValue& value) -> std::optional<double> {
        if (const auto* whole = std::get_if<std::int64_t>(&value)) {
            return static_cast<double>(*whole);
        }
        if (const auto* real = std::get_if<double>(&value)) return *real;
        return std::nullopt;
    };
    if (number(a) && number(b)) return *number(a) < *number(b);
    return to_string(a) < to_string(b);
}

std::vector<std::string> parameter_values(const std::vector<PivotCell>& cells,
                                          const std::string& axis) {
    std::vector<ParameterValue> found;
    bool is_missing = false;
    for (const PivotCell& cell : cells) {
        const auto at = cell.cell->parameters.find(axis);
        if (at == cell.cell->parameters.end()) {
            is_missing = true;
        } else {
            found.push_back(at->second);
        }
    }
    std::ranges::sort(found, is_before);
    std::vector<std::string> values;
    for (const ParameterValue& value : found) add_new(values, to_string(value));
    if (is_missing) values.emplace_back("–");
    return values;
}

// In the order in which a table shows them: the plan's.
std::vector<std::string> values_of(std::span<const Comparison> comparisons,
                                   const std::vector<PivotCell>& cells, const std::string& axis) {
    if (!is_fixed(axis)) return parameter_values(cells, axis);
    std::vector<std::string> values;
    for (const Comparison& comparison : comparisons) {
        if (axis == "scene") {
            for (const std::string& scene : comparison.scenes) add_new(values, scene);
        } else if (axis == "method") {
            for (const std::string& method : comparison.methods) add_new(values, method);
        } else if (axis == "budget") {
            for (const Budget& budget : comparison.budgets) add_new(values, to_string(budget));
        } else {
            add_new(values, axis == "metric" ? comparison.metric : comparison.experiment);
        }
    }
    return values;
}

void require_axis(const std::vector<PivotCell>& cells, const std::string& axis) {
    if (is_fixed(axis)) return;
    std::set<std::string> parameters;
    for (const PivotCell& cell : cells) {
        for (const auto& [name, value] : cell.cell->parameters) parameters.insert(name);
    }
    if (parameters.contains(axis)) return;
    std::string known;
    for (const char* name : kFixedAxes) known.append(" ").append(name);
    for (const std::string& name : parameters) known.append(" ").append(name);
    throw Error(Errc::InvalidArgument, "unknown axis '" + axis + "'; known:" + known);
}

std::vector<std::string> place_of(const PivotCell& cell, const std::vector<std::string>& axes) {
    std::vector<std::string> place;
    for (const std::string& axis : axes) place.push_back(value_along(cell, axis));
    return place;
}

bool tell_apart(const std::vector<PivotCell>& cells, const std::vector<std::string>& axes) {
    std::set<std::vector<std::string>> places;
    return std::ranges::all_of(
        cells, [&](const PivotCell& cell) { return places.insert(place_of(cell, axes)).second; });
}

// The axes that rows need beside `axes`: one if one will do.
std::vector<std::string> further_axes(const std::vector<PivotCell>& cells,
                                      std::vector<std::string> axes) {
    std::vector<std::string> further;
    while (!tell_apart(cells, axes)) {
        std::string next;
        for (const std::string axis : kFixedAxes) {
            if (std::ranges::find(axes, axis) != axes.end()) continue;
            std::vector<std::string> with = axes;
            with.push_back(axis);
            if (tell_apart(cells, with)) {
                next = axis;
                break;
            }
            std::set<std::string> values;
            for (const PivotCell& cell : cells) values.insert(value_along(cell, axis));
            if (next.empty() && values.size() > 1) next = axis;
        }
        if (next.empty()) throw Error(Errc::Internal, "lay out table: two cells are the same");
        further.push_back(next);
        axes.push_back(next);
    }
    return further;
}

}  // namespace

std::string value_along(const PivotCell& cell, const std::string& axis) {
    if (axis == "scene") return cell.cell->scene;
    if (axis == "method") return cell.cell->method;
    if (axis == "budget") return to_string(cell.cell->budget);
    if (axis == "metric") return cell.comparison->metric;
    if (axis == "experiment") return cell.comparison->experiment;
    const auto found = cell.cell->parameters.find(axis);
    return found == cell.cell->parameters.end() ? "–" : to_string(found->second);
}

Pivot pivot(std::span<const Comparison> comparisons, const std::string& rows,
            const std::string& columns) {
    if (rows == columns) {
        throw Error(Errc::InvalidArgument,
                    "lay out table: rows and columns are both '" + rows + "'");
    }
    const std::vector<PivotCell> cells = all_cells(comparisons);
    require_axis(cells, rows);
    require_axis(cells, columns);
    Pivot result{.row_axes = {rows}, .columns = values_of(comparisons, cells, columns), .rows = {}};
    for (const std::string& axis : further_axes(cells, {rows, columns})) {
        result.row_axes.push_back(axis);
    }
    std::vector<std::vector<std::string>> values;
    for (const std::string& axis : result.row_axes) {
        values.push_back(values_of(comparisons, cells, axis));
    }
    std::map<std::vector<std::size_t>, Pivot::Row> by_place;
    const auto index = [](const std::vector<std::string>& list, const std::string& value) {
        return static_cast<std::size_t>(std::ranges::find(list, value) - list.begin());
    };
    for (const PivotCell& cell : cells) {
        std::vector<std::size_t> place;
        Pivot::Row row;
        for (std::size_t a = 0; a < result.row_axes.size(); ++a) {
            row.labels.push_back(value_along(cell, result.row_axes[a]));
            place.push_back(index(values[a], row.labels.back()));
        }
        Pivot::Row& there = by_place.try_emplace(place, std::move(row)).first->second;
        there.cells[index(result.columns, value_along(cell, columns))] = cell;
    }
    for (auto& [place, row] : by_place) result.rows.push_back(std::move(row));
    return result;
}

}  // namespace misbench
