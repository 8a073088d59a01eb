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
//   seeds          a count N (seeds 1 … N), a list, or              (required)
//                  {min: A, max: B, until: {ratio_halfwidth: H}}:
//                  seeds 1 … A, and further ones up to B until
//                  the 95 % interval of the ratio to the baseline
//                  in the first metric has a half width of H
//                  (0.1 is 10 %)
//   budgets        list of {samples: N} or                          (required)
//                  {seconds: S, clock: cpu|wall}                    clock: cpu
//   snapshots      F, or {factor: F, first: N}: keep each tested    none; first: 1
//                  image after N passes too, and each time after F
//                  times as many
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
//   profiles       PROFILE: {KEY: value, …}: the same experiment    none
//                  at another size; overrides keys of this table
//                  but name and profiles (profile.h)
//   claims         list of what is said about the methods, below    none
//
// A claim is about the ratio error(method)/error(against):
//
//   claim          what is said, in words                           (required)
//   where          where in the paper                               ""
//   scenes         list of scenes                                   all
//   method         a label of methods, or imported:LABEL of         (required)
//                  images of another renderer
//   against        another label                                    the baseline
//   metric         one of metrics, or seconds_per_pass              the first
//   budget         one of budgets                                   the first
//   over           each: every scene by itself; mean: geometric     each
//                  mean over the scenes; worst, best: the largest
//                  and the smallest ratio
//   expect         less, more, not_more, not_less, equal            (required)
//   margin         what counts as noticeable, above 0 and at most   0.05
//                  1: between 1/(1 + margin) and 1 + margin a
//                  ratio does not
//   paper          the paper's ratio; over each also                none
//                  {SCENE: ratio}
//   note           what we found out about it                       ""
//
// Two further sources change the file before anything is checked: --profile NAME takes a profile
// (else the first one is taken), and then --set PATH=VALUE one value at a time (override.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/budget_entry.h"
#include "experiments/plan/claim_entry.h"
#include "experiments/plan/experiment.h"
#include "experiments/plan/profile.h"
#include "experiments/plan/yaml_reader.h"
#include "renderer/base/parameters.h"
#include "renderer/base/snapshots.h"

namespace misbench {

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
    ChosenProfile profile;
    std::string name;
    std::string description;
    std::vector<SceneEntry> scenes;
    std::vector<MethodEntry> methods;
    std::vector<Placed<std::int64_t>> seeds;  // all that a seed rule allows
    std::optional<SeedRule> seed_rule;
    std::vector<Placed<Budget>> budgets;
    std::optional<SnapshotLadder> snapshots;
    ReferenceEntry reference;
    std::vector<Rule> include;
    std::vector<Rule> exclude;
    std::optional<Placed<std::string>> baseline;
    std::vector<Placed<std::string>> metrics;
    std::vector<ClaimEntry> claims;
};

inline constexpr std::int64_t kMaxSeeds = 100'000;
inline constexpr std::int64_t kFewestSeedsOfRule = 3;  // fewer have no interval
inline constexpr std::int64_t kMaxImageSide = 16'384;
inline constexpr std::int64_t kMaxSnapshotFactor = 1000;

// Throws NotFound when there is no file, InvalidArgument with the place of what is wrong.
ExperimentYaml read_experiment_yaml(const std::filesystem::path& file,
                                    const std::vector<std::string>& overrides = {},
                                    const std::string& profile = "");

// Whether this is a file for `misbench lab`, which lies among experiments and is none.
bool is_lab_file(const std::filesystem::path& file);

}  // namespace misbench
