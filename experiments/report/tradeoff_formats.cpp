#include "experiments/report/tradeoff_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/report/numbers.h"
#include "experiments/report/table_formats.h"

namespace misbench {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kNone = "–";

// --- tables, one step before a format ------------------------------------------------------------

struct Grid {
    std::string title;
    std::vector<std::vector<std::string>> rows;  // the first one is the header
};
struct Page {
    std::string title;
    std::vector<Grid> grids;
    std::vector<std::string> footer;
};

std::string to_text(const Page& page) {
    std::string text = page.title + "\n";
    for (const Grid& grid : page.grids) {
        std::vector<std::size_t> widths(grid.rows.front().size());
        for (const auto& row : grid.rows) {
            for (std::size_t c = 0; c < row.size(); ++c) {
                widths[c] = std::max(widths[c], display_width(row[c]));
            }
        }
        text += "\n" + grid.title + "\n";
        for (const auto& row : grid.rows) {
            std::string line = " ";
            for (std::size_t c = 0; c < row.size(); ++c)
                line += " " + padded(row[c], widths[c]) + " ";
            text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
        }
    }
    text += "\n";
    for (const std::string& line : page.footer) text += line + "\n";
    return text;
}

std::string to_markdown(const Page& page) {
    std::string text = "**" + escape_markdown(page.title) + "**\n";
    for (const Grid& grid : page.grids) {
        text += "\n" + escape_markdown(grid.title) + "\n\n";
        for (const auto& row : grid.rows) {
            text += "|";
            for (const std::string& cell : row) text += " " + escape_markdown(cell) + " |";
            text += "\n";
            if (&row != &grid.rows.front()) continue;
            text += "|";
            for (std::size_t c = 0; c < row.size(); ++c) text += "---|";
            text += "\n";
        }
    }
    text += "\n";
    for (const std::string& line : page.footer) text += escape_markdown(line) + "  \n";
    return text;
}

// --- what all formats say ------------------------------------------------------------------------

std::string effort_text(double effort) { return fmt::format("{:.4g}", effort); }

std::string slope_text(const std::optional<Estimate>& slope) {
    return slope ? format_mean(*slope) : kNone;
}

std::string floor_text(const std::optional<Estimate>& floor) {
    if (!floor) return kNone;
    if (has_floor(*floor)) return format_mean(*floor);
    if (!floor->interval) return "unknown";
    return fmt::format("none found, at most {:.2g}", std::max(0.0, floor->interval->high));
}

std::string range_text(const Estimate& effort) {
    if (!effort.interval) return fmt::format("{:.3g}", effort.value);
    return fmt::format("{:.3g} [{:.3g}, {:.3g}]", effort.value, effort.interval->low,
                       effort.interval->high);
}

std::string target_text(const std::optional<EffortTo>& to) {
    if (!to) return kNone;
    switch (to->where) {
        case EffortTo::Where::Within:
            return range_text(*to->effort);
        case EffortTo::Where::Before:
            return fmt::format("at most {:.3g}", to->effort->value);
        case EffortTo::Where::Beyond:
            return range_text(*to->effort) + " »";
        case EffortTo::Where::Never:
            break;
    }
    return "never";
}

std::string crossover_text(const std::optional<Crossover>& found) {
    if (!found) return kNone;
    if (found->n_crossings == 0) {
        return found->is_first_ahead ? "ahead throughout" : "behind throughout";
    }
    std::string text = fmt::format("{} from {}", found->is_last_ahead ? "ahead" : "behind",
                                   range_text(*found->effort));
    if (found->n_crossings > 1) text += fmt::format(", last of {}", found->n_crossings);
    return text;
}

Page page_of(const Tradeoff& tradeoff) {
    const std::string unit = to_string(tradeoff.effort);
    Page page{
        .title = fmt::format("{}: what {} costs in {}", tradeoff.experiment, tradeoff.metric, unit),
        .grids = {},
        .footer = {}};
    for (const TradeoffScene& scene : tradeoff.scenes) {
        Grid methods{.title = scene.scene,
                     .rows = {{"method", "slope", "floor",
                               scene.target ? fmt::format("{} to {:.3g}", unit, *scene.target)
                                            : unit + " to error",
                               "against " + tradeoff.baseline}}};
        Grid points{.title = scene.scene + ", points",
                    .rows = {{"method", "spp", tradeoff.metric, "front"}}};
        const bool is_timed = tradeoff.effort != Effort::Passes;
        if (is_timed) points.rows[0].insert(points.rows[0].begin() + 1, unit);
        for (const TradeoffMethod& method : scene.methods) {
            methods.rows.push_back({method.method, slope_text(method.slope),
                                    floor_text(method.floor), target_text(method.to_target),
                                    method.method == tradeoff.baseline
                                        ? ""
                                        : crossover_text(method.against_baseline)});
            for (const TradeoffPoint& p : method.points) {
                std::vector<std::string> row{
                    method.method, effort_text(p.point.passes) + (p.point.is_snapshot ? " °" : ""),
                    format_mean(*p.point.mean), p.is_on_front ? "•" : ""};
                if (is_timed) row.insert(row.begin() + 1, effort_text(p.effort));
                points.rows.push_back(std::move(row));
            }
        }
        page.grids.push_back(std::move(methods));
        page.grids.push_back(std::move(points));
    }
    if (!tradeoff.overall.empty()) {
        Grid overall{.title = "all scenes, relative to " + tradeoff.baseline,
                     .rows = {{"budget", "method", "scenes", "effort", "error", "front"}}};
        for (const OverallTradeoff& row : tradeoff.overall) {
            overall.rows.push_back(
                {to_string(row.budget), row.method, std::to_string(row.n_scenes),
                 fmt::format("×{:.3g}", row.cost),
                 row.method == tradeoff.baseline ? "baseline" : format_ratio(row.error),
                 row.is_on_front ? "•" : ""});
        }
        page.grids.push_back(std::move(overall));
    }
    const auto percent = static_cast<int>(100 * kConfidence + 0.5);
    page.footer = {
        fmt::format("± and [ ]: {} % intervals over the seeds; efforts are means over the seeds",
                    percent),
        "slope: b of error ~ effort^-b, 1 for independent samples without bias; floor: c of error "
        "= "
        "a/spp + c",
        "»: beyond the longest budget, by the slope of the mean curve",
        "•: no method has a smaller error at no larger effort (of the means); °: a snapshot, on "
        "the "
        "way of a longer render",
        fmt::format("{} to an error: {}", unit,
                    tradeoff.is_target_given
                        ? "the one asked for"
                        : "that of '" + tradeoff.baseline + "' at its last effort"),
        "against: which curve of means is lower, within the efforts that both have; its last "
        "crossing is given with its interval"};
    return page;
}

Page page_of(const ParameterTradeoff& tradeoff) {
    Page page{.title = fmt::format("{}: what {} costs by {}", tradeoff.experiment, tradeoff.metric,
                                   tradeoff.parameter),
              .grids = {},
              .footer = {}};
    for (const ParameterLadder& ladder : tradeoff.ladders) {
        Grid grid{.title = fmt::format("{}, {}{}", ladder.scene, to_string(ladder.budget),
                                       ladder.others.empty() ? "" : "; " + ladder.others),
                  .rows = {{tradeoff.parameter, "method", tradeoff.metric, "s cpu", "s cpu/spp",
                            "error", "cost", "price"}}};
        for (const ParameterStep& step : ladder.steps) {
            const bool is_first = &step == &ladder.steps.front();
            grid.rows.push_back({step.value, step.method, format_mean(step.error),
                                 effort_text(step.cpu_seconds), effort_text(step.seconds_per_pass),
                                 step.error_ratio ? format_ratio(*step.error_ratio)
                                 : is_first       ? ""
                                                  : kNone,
                                 is_first ? "" : fmt::format("×{:.3g}", step.cost_ratio),
                                 is_first     ? ""
                                 : step.price ? fmt::format("{:.2g}", *step.price)
                                              : kNone});
        }
        page.grids.push_back(std::move(grid));
    }
    page.footer = {"error, cost: relative to the row above, with its interval over the seeds",
                   "price: percent of cost for each percent of error that is gained; – where no "
                   "gain is shown"};
    return page;
}

// --- numbers for programs ------------------------------------------------------------------------

void put(Json& row, const std::string& name, const std::optional<Estimate>& estimate) {
    row[name] = estimate ? Json(estimate->value) : Json();
    const bool bounded = estimate && estimate->interval;
    row[name + "_low"] = bounded ? Json(estimate->interval->low) : Json();
    row[name + "_high"] = bounded ? Json(estimate->interval->high) : Json();
}

const char* name_of(EffortTo::Where where) {
    switch (where) {
        case EffortTo::Where::Within:
            return "within";
        case EffortTo::Where::Before:
            return "before";
        case EffortTo::Where::Beyond:
            return "beyond";
        case EffortTo::Where::Never:
            break;
    }
    return "never";
}

void put_fits(Json& row, const TradeoffScene& scene, const TradeoffMethod& method) {
    put(row, "slope", method.slope);
    put(row, "floor", method.floor);
    row["target"] = scene.target ? Json(*scene.target) : Json();
    row["target_reached"] = method.to_target ? Json(name_of(method.to_target->where)) : Json();
    put(row, "effort_to_target", method.to_target ? method.to_target->effort : std::nullopt);
    const auto& crossing = method.against_baseline;
    row["crossings"] = crossing ? Json(crossing->n_crossings) : Json();
    row["ahead_at_first"] = crossing ? Json(crossing->is_first_ahead) : Json();
    row["ahead_at_last"] = crossing ? Json(crossing->is_last_ahead) : Json();
    put(row, "crossover", crossing ? crossing->effort : std::nullopt);
}

Json points_to_json(const Tradeoff& tradeoff) {
    Json rows = Json::array();
    for (const TradeoffScene& scene : tradeoff.scenes) {
        for (const TradeoffMethod& method : scene.methods) {
            for (const TradeoffPoint& p : method.points) {
                Json row = {{"experiment", tradeoff.experiment},
                            {"scene", scene.scene},
                            {"method", method.method},
                            {"metric", tradeoff.metric},
                            {"against", tradeoff.baseline},
                            {"effort_unit", to_string(tradeoff.effort)},
                            {"effort", p.effort},
                            {"passes", p.point.passes},
                            {"cpu_seconds", p.point.cpu_seconds},
                            {"wall_seconds", p.point.wall_seconds},
                            {"snapshot", p.point.is_snapshot},
                            {"seeds", p.point.values.size()}};
                put(row, "error", p.point.mean);
                row["on_front"] = p.is_on_front;
                put_fits(row, scene, method);
                rows.push_back(std::move(row));
            }
        }
    }
    return rows;
}

Json overall_to_json(const Tradeoff& tradeoff) {
    Json rows = Json::array();
    for (const OverallTradeoff& overall : tradeoff.overall) {
        Json row = {{"budget", to_string(overall.budget)},
                    {"method", overall.method},
                    {"scenes", overall.n_scenes},
                    {"effort_ratio", overall.cost}};
        put(row, "error_ratio", overall.error);
        row["on_front"] = overall.is_on_front;
        rows.push_back(std::move(row));
    }
    return rows;
}

Json steps_to_json(const ParameterTradeoff& tradeoff) {
    Json rows = Json::array();
    for (const ParameterLadder& ladder : tradeoff.ladders) {
        for (const ParameterStep& step : ladder.steps) {
            Json row = {{"experiment", tradeoff.experiment},
                        {"scene", ladder.scene},
                        {"budget", to_string(ladder.budget)},
                        {"others", ladder.others},
                        {"parameter", tradeoff.parameter},
                        {"value", step.value},
                        {"method", step.method},
                        {"metric", tradeoff.metric}};
            put(row, "error", step.error);
            row["cpu_seconds"] = step.cpu_seconds;
            row["cpu_seconds_per_pass"] = step.seconds_per_pass;
            put(row, "error_ratio", step.error_ratio);
            row["cost_ratio"] = step.cost_ratio;
            row["price"] = step.price ? Json(*step.price) : Json();
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

std::string to_csv(const Json& rows) {
    std::string csv;
    for (const Json& row : rows) {
        std::string header, line;
        for (const auto& [name, value] : row.items()) {
            header += (header.empty() ? "" : ",") + name;
            if (!line.empty()) line += ",";
            line += value.is_null()     ? ""
                    : value.is_string() ? escape_csv(value.get<std::string>())
                                        : value.dump();
        }
        if (csv.empty()) csv = header + "\n";
        csv += line + "\n";
    }
    return csv;
}

}  // namespace

std::string tradeoff_to_text(const Tradeoff& tradeoff) { return to_text(page_of(tradeoff)); }
std::string tradeoff_to_markdown(const Tradeoff& tradeoff) {
    return to_markdown(page_of(tradeoff));
}
std::string tradeoff_to_json(const Tradeoff& tradeoff) {
    const Json json = {{"points", points_to_json(tradeoff)},
                       {"overall", overall_to_json(tradeoff)}};
    return json.dump(2) + "\n";
}
std::string tradeoff_to_csv(const Tradeoff& tradeoff) { return to_csv(points_to_json(tradeoff)); }

std::string ladders_to_text(const ParameterTradeoff& tradeoff) {
    return to_text(page_of(tradeoff));
}
std::string ladders_to_markdown(const ParameterTradeoff& tradeoff) {
    return to_markdown(page_of(tradeoff));
}
std::string ladders_to_json(const ParameterTradeoff& tradeoff) {
    return steps_to_json(tradeoff).dump(2) + "\n";
}
std::string ladders_to_csv(const ParameterTradeoff& tradeoff) {
    return to_csv(steps_to_json(tradeoff));
}

}  // namespace misbench
