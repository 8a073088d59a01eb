#include "experiments/plan/experiment_file.h"

#include <algorithm>

#include "experiments/plan/override.h"
#include "experiments/plan/suggestion.h"

namespace misbench {
namespace {

constexpr std::int64_t kMaxSeed = INT64_MAX;
constexpr std::int64_t kReferenceSeedA = 1'000'001;
constexpr std::int64_t kReferenceSeedB = 1'000'002;
constexpr const char* kLabKey = "problems";

Placed<std::int64_t> read_seed(const YamlNode& node) {
    return {read_integer(node, "a seed", 0, kMaxSeed), node.place};
}

// The parameters among the keys of a map: all but `others`.
GivenParameters read_parameters(const YamlNode& map, const std::vector<std::string>& others) {
    GivenParameters parameters;
    for (const YamlNode& item : map.items) {
        if (std::ranges::find(others, item.key) != others.end()) continue;
        parameters.push_back(
            {item.key, read_parameter(item, item.key), item.key_place, item.place});
    }
    return parameters;
}

ImageSize read_image(const YamlNode* node, ImageSize size) {
    if (node == nullptr) return size;
    require_keys(*node, "image", {"width", "height"});
    if (const YamlNode* width = node->find("width")) {
        size.width = static_cast<int>(read_integer(*width, "width", 1, kMaxImageSide));
    }
    if (const YamlNode* height = node->find("height")) {
        size.height = static_cast<int>(read_integer(*height, "height", 1, kMaxImageSide));
    }
    return size;
}

SceneEntry read_scene(const YamlNode& node, ImageSize image) {
    SceneEntry entry;
    entry.image = image;
    if (node.kind != YamlNode::Kind::Map) {
        entry.scene = read_placed_text(node, "a scene");
        return entry;
    }
    require_keys(node, "a scene", {"scene", "image", "exposure", "parameters"});
    entry.scene = read_placed_text(require_value(node, "a scene", "scene"), "scene");
    entry.image = read_image(node.find("image"), image);
    if (const YamlNode* exposure = node.find("exposure")) {
        entry.exposure = read_number(*exposure, "exposure");
    }
    if (const YamlNode* parameters = node.find("parameters")) {
        require_map(*parameters, "parameters");
        entry.parameters = read_parameters(*parameters, {});
    }
    return entry;
}

MethodEntry read_method(const YamlNode& node) {
    const std::string what = "method '" + node.key + "'";
    require_map(node, what);
    if (node.key == "reference") {
        fail_at(node.key_place, "the label 'reference' stands for the reference itself");
    }
    return {.label = {node.key, node.key_place},
            .method = read_placed_text(require_value(node, what, "method"), "method"),
            .parameters = read_parameters(node, {"method"})};
}

std::optional<SeedRule> read_seed_rule(const YamlNode& node) {
    if (node.kind != YamlNode::Kind::Map) return std::nullopt;
    require_keys(node, "seeds", {"min", "max", "until"});
    const YamlNode& min = require_value(node, "seeds", "min");
    const YamlNode& max = require_value(node, "seeds", "max");
    const YamlNode& until = require_value(node, "seeds", "until");
    require_keys(until, "until", {"ratio_halfwidth"});
    const YamlNode& width = require_value(until, "until", "ratio_halfwidth");
    SeedRule rule;
    rule.min = static_cast<int>(read_integer(min, "min", kFewestSeedsOfRule, kMaxSeeds));
    rule.max = static_cast<int>(read_integer(max, "max", rule.min, kMaxSeeds));
    rule.ratio_halfwidth = read_number(width, "ratio_halfwidth");
    if (!(rule.ratio_halfwidth > 0 && rule.ratio_halfwidth <= 1)) {
        fail_at(width.place,
                "ratio_halfwidth must be above 0 and at most 1: found '" + width.text + "'");
    }
    return rule;
}

std::vector<Placed<std::int64_t>> read_seeds(const YamlNode& node,
                                             const std::optional<SeedRule>& rule) {
    std::vector<Placed<std::int64_t>> seeds;
    if (node.kind != YamlNode::Kind::Sequence) {
        const std::int64_t count =
            rule ? rule->max : read_integer(node, "seeds, a count or a list,", 1, kMaxSeeds);
        for (std::int64_t seed = 1; seed <= count; ++seed) seeds.push_back({seed, node.place});
        return seeds;
    }
    for (const YamlNode& item : read_one_or_more(node, "seeds")) {
        seeds.push_back(read_seed(item));
        const auto same = [&seeds](const auto& seed) { return seed.value == seeds.back().value; };
        if (!std::none_of(seeds.begin(), seeds.end() - 1, same)) {
            fail_at(item.place, "seed " + item.text + " is listed twice");
        }
    }
    return seeds;
}

std::vector<Placed<Budget>> read_budgets(const YamlNode& node) {
    std::vector<Placed<Budget>> budgets;
    for (const YamlNode& item : read_one_or_more(node, "budgets")) {
        const Placed<Budget> budget = read_budget(item);
        for (const auto& other : budgets) {
            if (other.value == budget.value) fail_at(item.place, "this budget is listed twice");
        }
        budgets.push_back(budget);
    }
    return budgets;
}

std::optional<SnapshotLadder> read_snapshots(const YamlNode* node) {
    if (node == nullptr) return std::nullopt;
    SnapshotLadder ladder;
    const YamlNode* factor = node;
    if (node->kind == YamlNode::Kind::Map) {
        require_keys(*node, "snapshots", {"factor", "first"});
        factor = &require_value(*node, "snapshots", "factor");
        if (const YamlNode* first = node->find("first")) {
            ladder.first = read_integer(*first, "first", 1, kMaxSamples);
        }
    }
    ladder.factor = read_integer(*factor, "the factor of snapshots", 2, kMaxSnapshotFactor);
    return ladder;
}

ReferenceEntry read_reference(const YamlNode& node) {
    require_map(node, "reference");
    ReferenceEntry reference{
        .method = read_placed_text(require_value(node, "reference", "method"), "method"),
        .parameters = read_parameters(node, {"method", "samples", "seeds"}),
        .samples =
            read_integer(require_value(node, "reference", "samples"), "samples", 1, kMaxSamples),
        .seed_a = {kReferenceSeedA, node.place},
        .seed_b = {kReferenceSeedB, node.place}};
    if (const YamlNode* seeds = node.find("seeds")) {
        if (seeds->kind != YamlNode::Kind::Sequence || seeds->items.size() != 2) {
            fail_at(seeds->place, "the reference's seeds must be a list of two");
        }
        reference.seed_a = read_seed(seeds->items[0]);
        reference.seed_b = read_seed(seeds->items[1]);
    }
    if (reference.seed_a.value == reference.seed_b.value) {
        fail_at(reference.seed_b.place, "the reference's halves must have different seeds");
    }
    return reference;
}

Rule read_rule(const YamlNode& node) {
    require_keys(node, "a rule", {"scene", "method", "seed", "budget"});
    Rule rule;
    rule.place = node.place;
    if (node.items.empty()) fail_at(node.place, "a rule must name an axis");
    for (const YamlNode& axis : node.items) {
        for (const YamlNode& value : read_one_or_more(axis, axis.key)) {
            if (axis.key == "scene") rule.scenes.push_back(read_placed_text(value, "a scene"));
            if (axis.key == "method") rule.methods.push_back(read_placed_text(value, "a method"));
            if (axis.key == "seed") rule.seeds.push_back(read_seed(value));
            if (axis.key == "budget") rule.budgets.push_back(read_budget(value));
        }
    }
    return rule;
}

std::vector<Rule> read_rules(const YamlNode* node) {
    std::vector<Rule> rules;
    if (node == nullptr) return rules;
    for (const YamlNode& item : read_one_or_more(*node, node->key))
        rules.push_back(read_rule(item));
    return rules;
}

std::vector<Placed<std::string>> read_metrics(const YamlNode* node) {
    if (node == nullptr) return {{"relmse.eps0.01", {}}};
    std::vector<Placed<std::string>> metrics;
    for (const YamlNode& item : read_one_or_more(*node, "metrics")) {
        metrics.push_back(read_placed_text(item, "a metric"));
    }
    return metrics;
}

}  // namespace

ParameterMap to_map(const GivenParameters& given) {
    ParameterMap map;
    for (const GivenParameter& parameter : given) map[parameter.name] = parameter.value;
    return map;
}

ExperimentYaml read_experiment_yaml(const std::filesystem::path& file,
                                    const std::vector<std::string>& overrides,
                                    const std::string& profile) {
    YamlNode root = read_yaml_file(file);
    if (const YamlNode* problems = root.find(kLabKey)) {
        fail_at(problems->key_place, "a file for `misbench lab`, not an experiment");
    }
    ExperimentYaml experiment;
    experiment.file = file;
    experiment.profile = apply_profile(root, profile);
    for (const std::string& assignment : overrides) apply_override(root, assignment);

    const std::string what = "the experiment file";
    require_keys(
        root, what,
        {"name", "description", "scenes", "methods", "seeds", "budgets", "image", "reference",
         "include", "exclude", "baseline", "metrics", "profiles", "claims", "snapshots"});
    experiment.name = read_word(require_value(root, what, "name"), "name");
    if (const YamlNode* description = root.find("description")) {
        experiment.description = read_text(*description, "description");
    }
    const ImageSize image = read_image(root.find("image"), {});
    const YamlNode& scenes = require_value(root, what, "scenes");
    for (const YamlNode& node : read_one_or_more(scenes, "scenes")) {
        experiment.scenes.push_back(read_scene(node, image));
    }
    const YamlNode& methods = require_value(root, what, "methods");
    require_map(methods, "methods");
    if (methods.items.empty()) fail_at(methods.place, "methods must not be empty");
    for (const YamlNode& node : methods.items) experiment.methods.push_back(read_method(node));
    const YamlNode& seeds = require_value(root, what, "seeds");
    experiment.seed_rule = read_seed_rule(seeds);
    experiment.seeds = read_seeds(seeds, experiment.seed_rule);
    experiment.budgets = read_budgets(require_value(root, what, "budgets"));
    experiment.snapshots = read_snapshots(root.find("snapshots"));
    experiment.reference = read_reference(require_value(root, what, "reference"));
    experiment.include = read_rules(root.find("include"));
    experiment.exclude = read_rules(root.find("exclude"));
    if (const YamlNode* baseline = root.find("baseline")) {
        experiment.baseline = read_placed_text(*baseline, "baseline");
    }
    experiment.metrics = read_metrics(root.find("metrics"));
    experiment.claims = read_claims(root.find("claims"));
    return experiment;
}

bool is_lab_file(const std::filesystem::path& file) {
    return read_yaml_file(file).find(kLabKey) != nullptr;
}

}  // namespace misbench
