// A figure's YAML file: what is shown of an experiment, and how. README.md beside this lists its
// keys. Names of scenes, methods, metrics and budgets are checked when the figure is made, against
// the experiment in the store; so they keep their places.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "experiments/analysis/tradeoff.h"
#include "experiments/figure/raster.h"
#include "experiments/plan/yaml_reader.h"

namespace misbench::figure {

// ACM's formats: a column, and the whole page.
inline constexpr double kColumnWidth = 240;
inline constexpr double kPageWidth = 506;
inline constexpr int kMaxCrops = 8;

struct AutomaticCrops {
    int count = 2;
    int width = 0;  // pixels
    int height = 0;
    Place place = {};
};
using Crops = std::variant<AutomaticCrops, std::vector<Placed<Window>>>;

struct SceneEntry {
    Placed<std::string> name;
    std::optional<double> exposure;  // in place of the experiment's
    std::optional<Crops> crops;      // in place of the panel's
};

// What the panel shows beside the images.
struct ErrorMaps {
    Placed<std::string> metric = {};
    bool logarithmic = false;
    std::optional<std::array<double, 2>> range = {};  // of the colours
    bool whole = false;  // a row of whole images' maps as well, where there are crops
};

// Scenes down, methods across. Without crops the cells are whole images.
struct ComparisonPanel {
    std::optional<Crops> crops;
    std::optional<ErrorMaps> maps;
    std::vector<Placed<std::string>> full;  // none, one, or two that share the image
    bool gain = false;  // captions say how many times less error, not the ratio of errors
};

// Error against effort, a plot for each scene. A Pareto plot marks what nothing beats in both.
struct EffortPanel {
    Effort effort = Effort::Cpu;
    bool pareto = false;
};
// Ratios of errors to the baseline's, with intervals, in groups by scene.
struct BarsPanel {};
// The same against a parameter of the methods, a line for each scene.
struct SweepPanel {
    Placed<std::string> parameter;
    std::optional<double> mark;  // a dashed line there
};
// Layers of an EXR file.
struct MapsPanel {
    std::filesystem::path file;
    std::vector<Placed<std::string>> layers;  // empty for all that have a name
    bool false_colours = true;
    bool logarithmic = false;
    std::optional<std::array<double, 2>> range = {};
    double exposure = 0;
    int columns = 0;  // 0: those of a row, but for techniques, which have a row a path length
};

struct Panel {
    Place place;
    std::string title = {};
    std::string experiment = {};                    // "" for the latest
    std::vector<SceneEntry> scenes = {};            // empty for all
    std::vector<Placed<std::string>> methods = {};  // empty for all
    // Of scenes, methods, layers and a sweep's parameter, with the places of the names.
    std::map<std::string, Placed<std::string>> titles = {};
    Placed<std::string> metric = {};  // "" for the experiment's first
    Placed<std::string> budget = {};  // "" for its only one; not of an EffortPanel
    std::variant<ComparisonPanel, EffortPanel, BarsPanel, SweepPanel, MapsPanel> kind;

    std::string title_of(const std::string& name) const;  // the name itself where there is none
};

struct FigureFile {
    double width = kColumnWidth;  // points
    double font_size = 7;
    std::vector<Panel> panels;
};

// Throws InvalidArgument with the place, NotFound for the file.
FigureFile read_figure_file(const std::filesystem::path& file);

}  // namespace misbench::figure
