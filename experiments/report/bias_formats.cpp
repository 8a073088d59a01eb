#include "experiments/report/bias_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/report/table_formats.h"

namespace misbench {
namespace {

std::string percent(double part) { return fmt::format("{:.2g} %", 100 * part); }

std::string signed_percent(double part) {
    return fmt::format("{:+.{}f} %", 100 * part, std::abs(part) < 0.1 ? 2 : 0);
}

std::string where_of(const PixelRect& tile) {
    return fmt::format("x {}…{}, y {}…{}", tile.x0, tile.x1 - 1, tile.y0, tile.y1 - 1);
}

bool is_image(const BiasCell& cell, const ScaleTest& scale) {
    return &scale == &cell.test->scales.back();
}

std::string name_of(const BiasCell& cell, const ScaleTest& scale) {
    return is_image(cell, scale) ? "image" : fmt::format("{} px", scale.side);
}

// Of the tile relative to what it should be; of a black one there is no such number.
std::string bias_of(const TileDifference& tile) {
    if (tile.second <= 0) return "light where there is none";
    return signed_percent(tile.first / tile.second - 1);
}

std::string seeds_of(const BiasCell& cell) {
    const std::string seeds = cell.n_seeds == cell.n_seeds_against
                                  ? std::to_string(cell.n_seeds)
                                  : fmt::format("{}, {}", cell.n_seeds, cell.n_seeds_against);
    return seeds + (cell.test && cell.test->is_paired ? " pairs" : "") +
           (cell.few_passes ? " †" : "");
}

std::string finding_of(const BiasCell& cell) {
    return to_string(cell.finding) + (cell.finding == BiasFinding::Biased ? " *" : "");
}

std::string strongest_of(const BiasCell& cell) {
    const TileDifference* tile = cell.test ? cell.test->strongest() : nullptr;
    const bool is_found = cell.finding == BiasFinding::Biased ||
                          cell.finding == BiasFinding::Negligible ||
                          cell.finding == BiasFinding::DarkOrRare;
    if (tile == nullptr || !is_found) return "";
    return fmt::format("{} in {}", bias_of(*tile), where_of(tile->tile));
}

std::string whole_image_of(const BiasCell& cell) {
    if (!cell.test || cell.test->scales.back().tiles.empty()) return "";
    return bias_of(cell.test->scales.back().tiles.front());
}

// "8 px 5.1 %, 32 px 2 %, image 0.3 %".
std::string detectable_of(const BiasCell& cell) {
    std::string text;
    if (!cell.test) return text;
    for (const ScaleTest& scale : cell.test->scales) {
        if (scale.detectable_of_tile <= 0) continue;
        // No method loses more than all of the light.
        text += fmt::format(
            "{}{} {}", text.empty() ? "" : ", ", name_of(cell, scale),
            scale.detectable_of_tile < 1 ? percent(scale.detectable_of_tile) : "> 100 %");
    }
    return text;
}

// "0.0053 + 2e-05".
std::string parts_of(const BiasCell& cell) {
    if (!cell.parts) return "";
    const double bias = cell.parts->bias_squared;
    return fmt::format("{:.3g} {} {:.2g}", cell.parts->variance, bias < 0 ? "-" : "+",
                       std::abs(bias));
}

std::vector<std::string> footer_of(const Bias& bias) {
    const auto any = [&bias](const auto& is_one) {
        return std::ranges::any_of(bias.cells, is_one);
    };
    std::vector<std::string> footer{
        fmt::format("* images differ from those of {}, at a rate of false findings of {} over all "
                    "scenes and methods (Benjamini and Hochberg); that one is taken for unbiased",
                    bias.against, percent(bias.alpha)),
        fmt::format("equivalent: the whole image is within ±{0} (two one-sided tests); within "
                    "margin: images differ, but every tile that is not dark is within ±{0}",
                    percent(bias.margin)),
        fmt::format("detectable: the bias of one tile that is found in {:.0f} of 100 experiments, "
                    "relative to the tile; median over tiles",
                    100 * kPower),
        "p values of the smallest tiles from 0 to 1: level without bias, high at the left with it"};
    if (any([](const BiasCell& cell) { return cell.parts.has_value(); })) {
        footer.push_back("variance + bias²: the parts of " + bias.metric +
                         " over all pixels, by the cross-seed estimator, which may be negative");
    }
    if (any([](const BiasCell& cell) { return cell.finding == BiasFinding::DarkOrRare; })) {
        footer.push_back(
            fmt::format("dark, or rare samples: more than {} of the method's light lies in tiles "
                        "over {:.0f} times too bright, so dark ones may be those that no seed has "
                        "met yet; more seeds tell",
                        percent(kMostInRareSamples), kRareTimes));
    }
    if (any([](const BiasCell& cell) { return cell.few_passes; })) {
        footer.push_back(few_passes_footnote() +
                         "; a time budget that ends after few passes is itself a bias");
    }
    return footer;
}

nlohmann::ordered_json tile_to_json(const TileDifference& tile) {
    return {{"x0", tile.tile.x0},
            {"y0", tile.tile.y0},
            {"x1", tile.tile.x1},
            {"y1", tile.tile.y1},
            {"mean", tile.first},
            {"mean_against", tile.second},
            {"standard_error", tile.standard_error},
            {"degrees_of_freedom", tile.degrees_of_freedom},
            {"p", tile.p_value},
            {"p_guarded", tile.guarded_p},
            {"p_adjusted", tile.adjusted_p}};
}

nlohmann::ordered_json scale_to_json(const BiasCell& cell, const ScaleTest& scale) {
    nlohmann::ordered_json json = {{"scale", name_of(cell, scale)},
                                   {"tests", scale.tiles.size()},
                                   {"smallest_adjusted_p", nullptr},
                                   {"detectable_of_tile", scale.detectable_of_tile},
                                   {"detectable_of_image", scale.detectable_of_image},
                                   {"equivalence_p", scale.equivalence_p},
                                   {"histogram", scale.histogram},
                                   {"strongest", nullptr}};
    const auto strongest = std::ranges::min_element(scale.tiles, {}, &TileDifference::adjusted_p);
    if (strongest == scale.tiles.end()) return json;
    json["smallest_adjusted_p"] = strongest->adjusted_p;
    json["strongest"] = tile_to_json(*strongest);
    return json;
}

}  // namespace

std::string histogram_of(const ScaleTest& scale) {
    constexpr std::array kBars = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    const int most = std::ranges::max(scale.histogram);
    std::string bars;
    for (const int count : scale.histogram) {
        const int height = most > 0 ? (count * 7 + most - 1) / most : 0;
        bars += kBars.at(static_cast<std::size_t>(height));
    }
    return bars;
}

Table bias_table(const Bias& bias) {
    Table table{.title = fmt::format("bias of {} against {} at {}", bias.experiment, bias.against,
                                     to_string(bias.budget)),
                .label_headers = {"scene", "method"},
                .columns = {"seeds", "finding", "p", "where most", "image", "variance + bias²",
                            "detectable", "p values"},
                .rows = {},
                .footer = footer_of(bias)};
    for (const BiasCell& cell : bias.cells) {
        TableRow row{.labels = {cell.scene, cell.method}, .cells = {}};
        const bool is_tested = cell.test && cell.test->strongest() != nullptr;
        for (const std::string& text :
             {seeds_of(cell), finding_of(cell),
              is_tested ? fmt::format("{:.2g}", cell.adjusted_p) : "", strongest_of(cell),
              whole_image_of(cell), parts_of(cell), detectable_of(cell),
              is_tested ? histogram_of(cell.test->scales.front()) : ""}) {
            row.cells.emplace_back().mean = text;
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::string bias_to_json(const Bias& bias) {
    nlohmann::ordered_json json = {{"experiment", bias.experiment},
                                   {"against", bias.against},
                                   {"budget", to_string(bias.budget)},
                                   {"margin", bias.margin},
                                   {"alpha", bias.alpha},
                                   {"metric", bias.metric},
                                   {"cells", nlohmann::ordered_json::array()}};
    for (const BiasCell& cell : bias.cells) {
        nlohmann::ordered_json row = {{"scene", cell.scene},
                                      {"method", cell.method},
                                      {"finding", to_string(cell.finding)},
                                      {"seeds", cell.n_seeds},
                                      {"seeds_against", cell.n_seeds_against},
                                      {"few_passes", cell.few_passes},
                                      {"is_paired", nullptr},
                                      {"p", nullptr},
                                      {"p_adjusted", nullptr},
                                      {"rare_share", nullptr},
                                      {"variance", nullptr},
                                      {"bias_squared", nullptr},
                                      {"scales", nlohmann::ordered_json::array()}};
        if (cell.test) {
            row["is_paired"] = cell.test->is_paired;
            row["p"] = cell.test->p_value;
            row["p_adjusted"] = cell.adjusted_p;
            row["rare_share"] = cell.test->rare_share;
            for (const ScaleTest& scale : cell.test->scales) {
                row["scales"].push_back(scale_to_json(cell, scale));
            }
        }
        if (cell.parts) {
            row["variance"] = cell.parts->variance;
            row["bias_squared"] = cell.parts->bias_squared;
        }
        json["cells"].push_back(std::move(row));
    }
    return json.dump(2) + "\n";
}

std::string bias_to_csv(const Bias& bias) {
    std::string csv =
        "scene,method,finding,seeds,seeds_against,p,p_adjusted,scale,tests,smallest_adjusted_p,"
        "detectable_of_tile,detectable_of_image,equivalence_p,x0,y0,x1,y1,mean,mean_against\n";
    for (const BiasCell& cell : bias.cells) {
        const std::string begin =
            fmt::format("{},{},{},{},{}", escape_csv(cell.scene), escape_csv(cell.method),
                        to_string(cell.finding), cell.n_seeds, cell.n_seeds_against);
        if (!cell.test) {
            csv += begin + std::string(14, ',') + "\n";
            continue;
        }
        for (const ScaleTest& scale : cell.test->scales) {
            csv += fmt::format("{},{},{},{},{}", begin, cell.test->p_value, cell.adjusted_p,
                               name_of(cell, scale), scale.tiles.size());
            const auto tile =
                std::ranges::min_element(scale.tiles, {}, &TileDifference::adjusted_p);
            const bool is_tested = tile != scale.tiles.end();
            csv += fmt::format(",{},{},{},{}", is_tested ? fmt::to_string(tile->adjusted_p) : "",
                               scale.detectable_of_tile, scale.detectable_of_image,
                               scale.equivalence_p);
            csv += is_tested ? fmt::format(",{},{},{},{},{},{}\n", tile->tile.x0, tile->tile.y0,
                                           tile->tile.x1, tile->tile.y1, tile->first, tile->second)
                             : std::string(6, ',') + "\n";
        }
    }
    return csv;
}

}  // namespace misbench
