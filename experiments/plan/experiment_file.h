// The experiment file: YAML as a user writes it, read into values that remember their place. Here
// only the form is checked; whether the names mean anything is for experiments/resolve.h.
//
//   key            value                                            default
//   name           word that names the experiment in a store        (required)
//   description    text                                             ""
//   scenes         list of scenes: a name of `misbench list         (required)
//                  scenes`, a path (from the experiment file), or
//                  {scene, image, exposure, parameters}: exposure in
//                  stops for display, parameters override those of
//                  every method that declares them
//   methods        LABEL: {method: NAME, PARAMETER: value, …}       (required)
//   seeds          a count N (seeds 1 … N) or a list                (required)
//   budgets        list of {samples: N} or                          (required)
//                  {seconds: S, clock: cpu|wall}                    clock: cpu
//   image          {width, height} in pixels                        640 × 480
//   reference      {method: LABEL or NAME, samples: N,              (required)
//                  seeds: [A, B], PARAMETER: value, …}: two          seeds: 1000001, 1000002
//                  independent halves, with seeds no test has
//   include        list of rules; a cell is kept when it matches    all
//                  one: {scene, method, seed, budget}, each a value
//                  or a list of values
//   exclude        list of rules; a cell that matches one is left   none
//                  out
//   baseline       a label of methods                               the first
//   metrics        list of ids of `misbench list metrics`           [relmse.eps0.01]
//
// Two further sources override the file, one value at a time: --set PATH=VALUE (override.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/yaml_reader.h"
#include "renderer/base/budget.h"
#include "renderer/base/parameters.h"

namespace misbench {

template <typename T>
struct Placed {
    T value{};
    Place place;
};

struct GivenParameter {
    std::string name;
    ParameterValue value;
    Place name_place;
    Place place;
};
using GivenParameters = std::vector<GivenParameter>;
ParameterMap to_map(const GivenParameters& given);

struct ImageSize {
    int width = 640;
    int height = 480;
};

struct SceneEntry {
    Placed<std::string> scene;  // a name or a path
    ImageSize image;            // the experiment's unless it has its own
    double exposure = 0;
    GivenParameters parameters;
};

struct MethodEntry {
    Placed<std::string> label;
    Placed<std::string> method;
    GivenParameters parameters;
};

struct ReferenceEntry {
    Placed<std::string> method;  // a label, or else a method's name
    GivenParameters parameters;
    std::int64_t samples = 0;
    Placed<std::int64_t> seed_a;
    Placed<std::int64_t> seed_b;
};

// Matches a cell when each axis that it names has the cell's value. Empty: not named.
struct Rule {
    Place place;
    std::vector<Placed<std::string>> scenes;
    std::vector<Placed<std::string>> methods;
    std::vector<Placed<std::int64_t>> seeds;
    std::vector<Placed<Budget>> budgets;
};

struct ExperimentYaml {
    std::filesystem::path file;
    std::string name;
    std::string description;
    std::vector<SceneEntry> scenes;
    std::vector<MethodEntry> methods;
    std::vector<Placed<std::int64_t>> seeds;
    std::vector<Placed<Budget>> budgets;
    ReferenceEntry reference;
    std::vector<Rule> include;
    std::vector<Rule> exclude;
    std::optional<Placed<std::string>> baseline;
    std::vector<Placed<std::string>> metrics;
};

inline constexpr std::int64_t kMaxSeeds = 100'000;
inline constexpr std::int64_t kMaxImageSide = 16'384;
inline constexpr std::int64_t kMaxSamples = 1'000'000'000;
inline constexpr double kMaxBudgetSeconds = 1e6;

// Throws NotFound when there is no file, InvalidArgument with the place of what is wrong.
ExperimentYaml read_experiment_yaml(const std::filesystem::path& file,
                                    const std::vector<std::string>& overrides = {});

}  // namespace misbench
