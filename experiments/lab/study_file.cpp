#include "experiments/lab/study_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/lab/curve_file.h"
#include "experiments/plan/override.h"
#include "experiments/plan/suggestion.h"
#include "experiments/plan/yaml_reader.h"
#include "renderer/base/error.h"
#include "renderer/mis/heuristics.h"

namespace misbench::lab {
namespace {

int read_count(const YamlNode& node, const std::string& what, int minimum, int maximum) {
    return static_cast<int>(read_integer(node, what, minimum, maximum));
}

std::string text_or_empty(const YamlNode& map, const std::string& key) {
    const YamlNode* node = map.find(key);
    return node == nullptr ? "" : read_text(*node, key);
}

// One of the names, as the place of its key says.
std::string read_one_of(const YamlNode& node, const std::string& what,
                        const std::vector<std::string>& known) {
    const std::string name = read_text(node, what);
    if (std::ranges::find(known, name) == known.end()) {
        fail_at(node.place, unknown_name(what, name, known));
    }
    return name;
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
    std::vector<std::string> names;
    for (const Named& one : all) names.push_back(one.name);
    return names;
}

// --- techniques ----------------------------------------------------------------------------------

Technique read_technique(const YamlNode& node, const Domain& domain) {
    const std::string what = "technique '" + node.key + "'";
    require_keys(node, what, {"density", "samples", "layout", "cells"});
    Density density = read_density(require_value(node, what, "density"), domain);
    const YamlNode* samples = node.find("samples");
    const int n_samples = samples == nullptr ? 1 : read_count(*samples, "samples", 1, kMaxSamples);
    Layout layout = Layout::Independent;
    if (const YamlNode* name = node.find("layout")) {
        const std::string text =
            read_one_of(*name, "layout", {"independent", "stratified", "shared"});
        if (text == "stratified") layout = Layout::Stratified;
        if (text == "shared") layout = Layout::Shared;
    }
    const YamlNode* cells = node.find("cells");
    if ((cells != nullptr) != (layout == Layout::Shared)) {
        fail_at(node.place, what + ": 'cells' belongs to the layout 'shared', which requires it");
    }
    const int n_cells = cells == nullptr ? 1 : read_count(*cells, "cells", 1, kMaxCells);
    return make_technique(node.key, std::move(density), n_samples, layout, n_cells);
}

Problem read_problem(const YamlNode& node) {
    const std::string what = "problem '" + node.key + "'";
    Domain domain;
    if (const YamlNode* given = node.find("domain")) domain = read_interval(*given, "domain");
    Problem problem{.name = node.key,
                    .description = text_or_empty(node, "description"),
                    .domain = domain,
                    .integrand = read_curve(require_value(node, what, "integrand"), domain),
                    .techniques = {}};
    const YamlNode& techniques = require_value(node, what, "techniques");
    require_map(techniques, "techniques");
    if (techniques.items.empty()) fail_at(techniques.place, "techniques must not be empty");
    for (const YamlNode& item : techniques.items) {
        problem.techniques.push_back(read_technique(item, domain));
    }
    return problem;
}

// --- weights -------------------------------------------------------------------------------------

// "exact", or {pilot: N}.
MomentsFrom read_moments(const YamlNode& node, const std::string& what) {
    if (node.kind != YamlNode::Kind::Map) {
        read_one_of(node, what, {"exact"});
        return {};
    }
    require_keys(node, what, {"pilot"});
    return {read_count(require_value(node, what, "pilot"), "pilot", 2, kMaxPilot)};
}

CandidateGrid read_grid(const YamlNode& node, const Problem& problem) {
    require_keys(node, "correction", {"low", "high", "candidates", "fixed", "moments"});
    CandidateGrid grid;
    if (const YamlNode* low = node.find("low")) grid.low = read_number(*low, "low");
    if (const YamlNode* high = node.find("high")) grid.high = read_number(*high, "high");
    if (!(grid.low < grid.high)) fail_at(node.place, "correction: low must be below high");
    if (const YamlNode* candidates = node.find("candidates")) {
        grid.candidates = read_count(*candidates, "candidates", 2, 1000);
    }
    if (const YamlNode* fixed = node.find("fixed")) {
        for (const YamlNode& name : read_one_or_more(*fixed, "fixed")) {
            grid.fixed.push_back(read_one_of(name, "technique", names_of(problem.techniques)));
        }
    }
    if (const YamlNode* moments = node.find("moments")) {
        grid.moments = read_moments(*moments, "moments");
    }
    const auto n_free = static_cast<double>(problem.techniques.size() - grid.fixed.size());
    if (std::pow(grid.candidates, n_free) > kMaxCombinations) {
        fail_at(node.place, "correction: more than 1000000 combinations of candidates");
    }
    return grid;
}

HeuristicWeights read_heuristic_weights(const YamlNode& node, const std::string& what,
                                        const Problem& problem) {
    require_keys(node, what,
                 {"heuristic", "variance", "inverse_variance", "correlation", "correction",
                  "optimal", "only"});
    HeuristicWeights weights;
    if (const YamlNode* heuristic = node.find("heuristic")) {
        weights.heuristic = read_text(*heuristic, "heuristic");
        try {
            Heuristic::parse(weights.heuristic);
        } catch (const Error& e) {
            fail_at(heuristic->place, e.what());
        }
    }
    if (const YamlNode* from = node.find("variance")) {
        weights.variance = read_moments(*from, "variance");
    }
    if (const YamlNode* from = node.find("inverse_variance")) {
        weights.inverse_variance = read_moments(*from, "inverse_variance");
    }
    if (const YamlNode* correlation = node.find("correlation")) {
        read_one_of(*correlation, "correlation", {"popov"});
        weights.popov = true;
    }
    if (const YamlNode* correction = node.find("correction")) {
        weights.correction = read_grid(*correction, problem);
    }
    return weights;
}

OptimalWeights read_optimal_weights(const YamlNode& node, const std::string& what,
                                    const Problem& problem) {
    require_keys(node, what, {"optimal", "iterations"});
    const std::string how =
        read_one_of(*node.find("optimal"), "optimal", {"exact", "direct", "progressive"});
    if (IndependentTechniques(problem).counts().size() > kMaxOptimal) {
        fail_at(node.place, what + ": optimal weights know at most 64 techniques and strata");
    }
    const YamlNode* iterations = node.find("iterations");
    if ((iterations != nullptr) == (how == "exact")) {
        fail_at(node.place, what +
                                ": 'iterations' belongs to 'direct' and 'progressive', which "
                                "require it");
    }
    if (how == "exact") return {};
    return {how == "direct" ? OptimalWeights::How::Direct : OptimalWeights::How::Progressive,
            read_count(*iterations, "iterations", 1, kMaxIterations)};
}

Weighting read_weighting(const YamlNode& node, const Problem& problem) {
    const std::string what = "weights '" + node.key + "'";
    require_map(node, what);
    if (node.find("optimal") != nullptr) {
        return {node.key, read_optimal_weights(node, what, problem)};
    }
    if (const YamlNode* only = node.find("only")) {
        require_keys(node, what, {"only"});
        return {node.key,
                OneTechnique{read_one_of(*only, "technique", names_of(problem.techniques))}};
    }
    return {node.key, read_heuristic_weights(node, what, problem)};
}

// --- expectations --------------------------------------------------------------------------------

std::array<std::string, 2> read_two(const YamlNode& node, const std::vector<std::string>& known) {
    if (node.kind != YamlNode::Kind::Sequence || node.items.size() != 2) {
        fail_at(node.place, node.key + " must be a list of two weights");
    }
    return {read_one_of(node.items[0], "weights", known),
            read_one_of(node.items[1], "weights", known)};
}

std::vector<std::string> names_of_fixed(const std::vector<Weighting>& weightings) {
    std::vector<std::string> names;
    for (const Weighting& weighting : weightings) {
        const auto* optimal = std::get_if<OptimalWeights>(&weighting.kind);
        if (optimal == nullptr || optimal->how == OptimalWeights::How::Exact) {
            names.push_back(weighting.name);
        }
    }
    return names;
}

Expectation read_expectation(const YamlNode& node, const Problem& problem,
                             const std::vector<Weighting>& weightings) {
    const std::string what = "an expectation";
    require_keys(node, what,
                 {"claim", "note", "less", "factor", "equal", "within", "less_weight", "technique",
                  "at", "negative"});
    Expectation expectation{.claim = read_text(require_value(node, what, "claim"), "claim"),
                            .test = LessError{},
                            .note = text_or_empty(node, "note")};
    const auto number = [&](const std::string& key, double otherwise) {
        const YamlNode* value = node.find(key);
        return value == nullptr ? otherwise : read_number(*value, key);
    };
    if (const YamlNode* less = node.find("less")) {
        require_keys(node, what, {"claim", "note", "less", "factor"});
        const auto [a, b] = read_two(*less, names_of(weightings));
        expectation.test = LessError{a, b, number("factor", 1)};
    } else if (const YamlNode* equal = node.find("equal")) {
        require_keys(node, what, {"claim", "note", "equal", "within"});
        const auto [a, b] = read_two(*equal, names_of(weightings));
        expectation.test = EqualError{a, b, number("within", 1e-6)};
    } else if (const YamlNode* weight = node.find("less_weight")) {
        require_keys(node, what, {"claim", "note", "less_weight", "technique", "at"});
        const auto [a, b] = read_two(*weight, names_of_fixed(weightings));
        const YamlNode& at = require_value(node, what, "at");
        const double x = read_number(at, "at");
        if (!problem.domain.contains(x)) fail_at(at.place, "at must be in the domain");
        expectation.test = LessWeight{a, b,
                                      read_one_of(require_value(node, what, "technique"),
                                                  "technique", names_of(problem.techniques)),
                                      x};
    } else if (const YamlNode* negative = node.find("negative")) {
        require_keys(node, what, {"claim", "note", "negative"});
        expectation.test =
            NegativeWeight{read_one_of(*negative, "weights", names_of_fixed(weightings))};
    } else {
        fail_at(node.place, "an expectation has one of: less equal less_weight negative");
    }
    return expectation;
}

Case read_case(const YamlNode& node, const YamlNode* weights_of_all) {
    const std::string what = "problem '" + node.key + "'";
    require_keys(node, what,
                 {"description", "domain", "integrand", "techniques", "weights", "expect"});
    Case result{.problem = read_problem(node), .weightings = {}, .expectations = {}};
    for (const YamlNode* weights : {weights_of_all, node.find("weights")}) {
        if (weights == nullptr) continue;
        require_map(*weights, "weights");
        for (const YamlNode& item : weights->items) {
            const auto names = names_of(result.weightings);
            if (std::ranges::find(names, item.key) != names.end()) {
                fail_at(item.key_place, "weights '" + item.key + "' are there for all problems");
            }
            result.weightings.push_back(read_weighting(item, result.problem));
        }
    }
    if (result.weightings.empty()) fail_at(node.place, what + " has no 'weights'");
    if (const YamlNode* expect = node.find("expect")) {
        for (const YamlNode& item : read_one_or_more(*expect, "expect")) {
            result.expectations.push_back(
                read_expectation(item, result.problem, result.weightings));
        }
    }
    return result;
}

}  // namespace

Study read_study(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    YamlNode root = read_yaml_file(file);
    for (const std::string& assignment : overrides) apply_override(root, assignment);
    const std::string what = "the laboratory file";
    require_keys(root, what, {"name", "description", "seed", "runs", "weights", "problems"});
    Study study;
    study.name = read_text(require_value(root, what, "name"), "name");
    study.description = text_or_empty(root, "description");
    if (const YamlNode* seed = root.find("seed")) {
        study.seed = read_integer(*seed, "seed", 0, INT64_MAX);
    }
    if (const YamlNode* runs = root.find("runs")) {
        study.runs = read_count(*runs, "runs", 0, kMaxRuns);
        if (study.runs != 0 && study.runs < kFewestForInterval) {
            fail_at(runs->place, "runs must be 0 or at least 3");
        }
    }
    const YamlNode& problems = require_value(root, what, "problems");
    require_map(problems, "problems");
    if (problems.items.empty()) fail_at(problems.place, "problems must not be empty");
    for (const YamlNode& node : problems.items) {
        require_map(node, "problem '" + node.key + "'");
        study.cases.push_back(read_case(node, root.find("weights")));
    }
    return study;
}

}  // namespace misbench::lab
