#include "experiments/figure/figure_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

namespace misbench::figure {
namespace {

constexpr int kMaxSide = 16'384;  // of a crop, pixels

std::size_t read_choice(const YamlNode& node, const std::string& what,
                        const std::vector<std::string>& known) {
    const std::string text = read_text(node, what);
    const auto found = std::ranges::find(known, text);
    if (found == known.end()) {
        fail_at(node.place,
                fmt::format("unknown {} '{}'; known: {}", what, text, fmt::join(known, " ")));
    }
    return static_cast<std::size_t>(found - known.begin());
}

// Text that is drawn: one line of UTF-8.
std::string read_title(const YamlNode& node, const std::string& what) {
    const std::string text = read_text(node, what);
    const auto is_control = [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    };
    if (std::ranges::any_of(text, is_control)) {
        fail_at(node.place, what + " must be one line without control characters");
    }
    try {
        (void)nlohmann::json(text).dump();  // throws for what is not UTF-8
    } catch (const nlohmann::json::exception&) {
        fail_at(node.place, what + " must be UTF-8");
    }
    return text;
}

// column, page, or a number with its unit.
double read_width(const YamlNode& node) {
    const std::string text = read_text(node, "width");
    if (text == "column") return kColumnWidth;
    if (text == "page") return kPageWidth;
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    std::string unit(end, text.data() + text.size());
    std::erase(unit, ' ');
    const std::map<std::string, double> points = {
        {"pt", 1.0}, {"mm", 72 / 25.4}, {"cm", 72 / 2.54}, {"in", 72.0}};
    const auto scale = points.find(unit);
    if (error != std::errc() || scale == points.end()) {
        fail_at(node.place,
                "width must be column, page, or a number with pt, mm, cm or in, as "
                "'84 mm'; found '" +
                    text + "'");
    }
    const double width = number * scale->second;
    if (!(width >= 72 && width <= 2000)) {
        fail_at(node.place, "width must be within 72 and 2000 pt");
    }
    return width;
}

std::array<double, 2> read_range(const YamlNode& node, bool logarithmic) {
    if (node.kind != YamlNode::Kind::Sequence || node.items.size() != 2) {
        fail_at(node.place, "range must be a list of two numbers, low and high");
    }
    const double low = read_number(node.items[0], "range");
    const double high = read_number(node.items[1], "range");
    if (!(low < high)) fail_at(node.place, "range: low must be below high");
    if (logarithmic && low <= 0) {
        fail_at(node.place, "range: low must be above 0 on a logarithmic scale");
    }
    return {low, high};
}

Window read_window(const YamlNode& node) {
    if (node.kind != YamlNode::Kind::Sequence || node.items.size() != 4) {
        fail_at(node.place, "a crop must be a list of four: x, y, width, height in pixels");
    }
    const auto side = [&node](std::size_t i, int minimum) {
        return static_cast<int>(read_integer(node.items[i], "a crop's side", minimum, kMaxSide));
    };
    return {side(0, 0), side(1, 0), side(2, 1), side(3, 1)};
}

Crops read_crops(const YamlNode& node) {
    if (node.kind == YamlNode::Kind::Map) {
        require_keys(node, "crops", {"auto", "size"});
        const YamlNode& size = require_value(node, "crops", "size");
        if (size.kind != YamlNode::Kind::Sequence || size.items.size() != 2) {
            fail_at(size.place, "size must be a list of two: width and height in pixels");
        }
        const auto side = [&size](std::size_t i) {
            return static_cast<int>(read_integer(size.items[i], "size", 1, kMaxSide));
        };
        return AutomaticCrops{static_cast<int>(read_integer(require_value(node, "crops", "auto"),
                                                            "auto", 1, kMaxCrops)),
                              side(0), side(1), node.place};
    }
    if (node.kind != YamlNode::Kind::Sequence || node.items.empty()) {
        fail_at(node.place,
                "crops must be a list of [x, y, width, height], or {auto: N, size: [w, h]}");
    }
    if (static_cast<int>(node.items.size()) > kMaxCrops) {
        fail_at(node.place, fmt::format("crops: at most {}", kMaxCrops));
    }
    std::vector<Placed<Window>> windows;
    for (const YamlNode& item : node.items) windows.push_back({read_window(item), item.place});
    return windows;
}

ErrorMaps read_maps(const YamlNode& node) {
    require_keys(node, "maps", {"metric", "scale", "range", "whole"});
    ErrorMaps maps{.metric = read_placed_text(require_value(node, "maps", "metric"), "metric")};
    if (const YamlNode* scale = node.find("scale")) {
        maps.logarithmic = read_choice(*scale, "scale", {"linear", "log"}) == 1;
    }
    if (const YamlNode* range = node.find("range")) {
        maps.range = read_range(*range, maps.logarithmic);
    }
    if (const YamlNode* whole = node.find("whole")) maps.whole = read_bool(*whole, "whole");
    return maps;
}

std::vector<Placed<std::string>> read_names(const YamlNode& node, const std::string& what) {
    std::vector<Placed<std::string>> names;
    for (const YamlNode& item : read_one_or_more(node, what)) {
        names.push_back(read_placed_text(item, what));
    }
    return names;
}

SceneEntry read_scene(const YamlNode& node, bool has_images) {
    if (!has_images || node.kind != YamlNode::Kind::Map) {
        return {.name = read_placed_text(node, "scene"), .exposure = {}, .crops = {}};
    }
    require_keys(node, "a scene", {"scene", "exposure", "crops"});
    SceneEntry entry{.name = read_placed_text(require_value(node, "a scene", "scene"), "scene"),
                     .exposure = {},
                     .crops = {}};
    if (const YamlNode* exposure = node.find("exposure")) {
        entry.exposure = read_number(*exposure, "exposure");
    }
    if (const YamlNode* crops = node.find("crops")) entry.crops = read_crops(*crops);
    return entry;
}

// --- kinds ---------------------------------------------------------------------------------------

ComparisonPanel read_comparison(const YamlNode& node) {
    ComparisonPanel panel;
    if (const YamlNode* crops = node.find("crops")) panel.crops = read_crops(*crops);
    if (const YamlNode* maps = node.find("maps")) panel.maps = read_maps(*maps);
    if (const YamlNode* full = node.find("full")) {
        panel.full = read_names(*full, "full");
        if (panel.full.size() > 2) fail_at(full->place, "full: one method, or two to split it");
    }
    if (const YamlNode* ratio = node.find("ratio")) {
        panel.gain = read_choice(*ratio, "ratio", {"error", "gain"}) == 1;
    }
    return panel;
}

EffortPanel read_effort(const YamlNode& node, bool pareto) {
    EffortPanel panel{.pareto = pareto};
    if (const YamlNode* effort = node.find("effort")) {
        panel.effort =
            static_cast<Effort>(read_choice(*effort, "effort", {"cpu", "wall", "passes"}));
    }
    return panel;
}

SweepPanel read_sweep(const YamlNode& node) {
    SweepPanel panel{
        .parameter = read_placed_text(require_value(node, "a sweep", "parameter"), "parameter"),
        .mark = {}};
    if (const YamlNode* mark = node.find("mark")) panel.mark = read_number(*mark, "mark");
    return panel;
}

MapsPanel read_layers(const YamlNode& node) {
    MapsPanel panel;
    // Beside the figure's file, wherever that is called from.
    const YamlNode& file = require_value(node, "maps", "file");
    panel.file = std::filesystem::path(node.place.source).parent_path() / read_text(file, "file");
    if (const YamlNode* layers = node.find("layers")) panel.layers = read_names(*layers, "layers");
    if (const YamlNode* show = node.find("show")) {
        panel.false_colours = read_choice(*show, "show", {"false-colours", "image"}) == 0;
    }
    for (const char* key : {"scale", "range", "exposure"}) {
        const bool is_of_colours = key != std::string_view("exposure");
        const YamlNode* value = node.find(key);
        if (value == nullptr || is_of_colours == panel.false_colours) continue;
        fail_at(value->key_place,
                fmt::format("{} needs show: {}", key, is_of_colours ? "false-colours" : "image"));
    }
    if (const YamlNode* scale = node.find("scale")) {
        panel.logarithmic = read_choice(*scale, "scale", {"linear", "log"}) == 1;
    }
    if (const YamlNode* range = node.find("range")) {
        panel.range = read_range(*range, panel.logarithmic);
    }
    if (const YamlNode* exposure = node.find("exposure")) {
        panel.exposure = read_number(*exposure, "exposure");
    }
    if (const YamlNode* columns = node.find("columns")) {
        panel.columns = static_cast<int>(read_integer(*columns, "columns", 1, 100));
    }
    return panel;
}

// A kind and the keys that it knows beside kind, title and titles.
struct Kind {
    std::string name;
    std::vector<std::string> keys;
    decltype(Panel::kind) (*read)(const YamlNode& node);
};

const std::vector<Kind>& kinds() {
    using Read = decltype(Panel::kind);
    static const std::vector<Kind> all = {
        {"comparison",
         {"experiment", "scenes", "methods", "metric", "budget", "crops", "maps", "full", "ratio"},
         [](const YamlNode& n) -> Read { return read_comparison(n); }},
        {"convergence",
         {"experiment", "scenes", "methods", "metric", "effort"},
         [](const YamlNode& n) -> Read { return read_effort(n, false); }},
        {"pareto",
         {"experiment", "scenes", "methods", "metric", "effort"},
         [](const YamlNode& n) -> Read { return read_effort(n, true); }},
        {"bars",
         {"experiment", "scenes", "methods", "metric", "budget"},
         [](const YamlNode&) -> Read { return BarsPanel{}; }},
        {"sweep",
         {"experiment", "scenes", "methods", "metric", "budget", "parameter", "mark"},
         [](const YamlNode& n) -> Read { return read_sweep(n); }},
        {"maps",
         {"file", "layers", "show", "scale", "range", "exposure", "columns"},
         [](const YamlNode& n) -> Read { return read_layers(n); }}};
    return all;
}

Panel read_panel(const YamlNode& node, const std::string& experiment) {
    require_map(node, "a panel");
    std::vector<std::string> names;
    for (const Kind& kind : kinds()) names.push_back(kind.name);
    const Kind& kind = kinds()[read_choice(require_value(node, "a panel", "kind"), "kind", names)];
    std::vector<std::string> keys = {"kind", "title", "titles"};
    keys.insert(keys.end(), kind.keys.begin(), kind.keys.end());
    require_keys(node, "a panel of kind " + kind.name, keys);

    Panel panel{.place = node.place, .experiment = experiment, .kind = kind.read(node)};
    const auto text = [&node](const char* key) {
        const YamlNode* value = node.find(key);
        return value == nullptr ? Placed<std::string>{} : read_placed_text(*value, key);
    };
    if (const YamlNode* title = node.find("title")) panel.title = read_title(*title, "title");
    panel.metric = text("metric");
    panel.budget = text("budget");
    if (node.find("experiment") != nullptr) panel.experiment = text("experiment").value;
    if (const YamlNode* scenes = node.find("scenes")) {
        for (const YamlNode& item : read_one_or_more(*scenes, "scenes")) {
            panel.scenes.push_back(read_scene(item, kind.name == "comparison"));
        }
    }
    if (const YamlNode* methods = node.find("methods")) {
        panel.methods = read_names(*methods, "methods");
    }
    if (const YamlNode* titles = node.find("titles")) {
        require_map(*titles, "titles");
        for (const YamlNode& item : titles->items) {
            panel.titles[item.key] = {read_title(item, "a title"), item.key_place};
        }
    }
    return panel;
}

}  // namespace

std::string Panel::title_of(const std::string& name) const {
    const auto found = titles.find(name);
    return found == titles.end() ? name : found->second.value;
}

FigureFile read_figure_file(const std::filesystem::path& file) {
    const YamlNode root = read_yaml_file(file);
    const std::string what = "the figure's file";
    require_keys(root, what, {"width", "font_size", "experiment", "panels"});
    FigureFile figure;
    if (const YamlNode* width = root.find("width")) figure.width = read_width(*width);
    if (const YamlNode* size = root.find("font_size")) {
        figure.font_size = read_number(*size, "font_size");
        if (!(figure.font_size >= 4 && figure.font_size <= 24)) {
            fail_at(size->place, "font_size must be within 4 and 24 points");
        }
    }
    std::string experiment;
    if (const YamlNode* name = root.find("experiment")) {
        experiment = read_text(*name, "experiment");
    }
    const YamlNode& panels = require_value(root, what, "panels");
    if (panels.kind != YamlNode::Kind::Sequence || panels.items.empty()) {
        fail_at(panels.place, "panels must be a list of one panel at least");
    }
    for (const YamlNode& node : panels.items) {
        figure.panels.push_back(read_panel(node, experiment));
    }
    return figure;
}

}  // namespace misbench::figure
