// A claim as it is written in an experiment file; experiment_file.h says how.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/claim.h"
#include "experiments/plan/yaml_reader.h"

namespace misbench {

struct PaperEntry {
    Placed<std::string> scene;  // "" where one number stands for all
    double ratio = 0;
};

struct ClaimEntry {
    Place place;
    std::string text;
    std::string where;
    std::vector<Placed<std::string>> scenes;  // none: all
    Placed<std::string> method;
    std::optional<Placed<std::string>> against;
    std::optional<Placed<std::string>> metric;
    std::optional<Placed<Budget>> budget;
    ClaimOver over = ClaimOver::Each;
    Expectation expect = Expectation::Less;
    double margin = kDefaultMargin;
    std::vector<PaperEntry> paper;
    std::string note;
};

inline constexpr double kMaxMargin = 1;

// Null: no claims.
std::vector<ClaimEntry> read_claims(const YamlNode* node);

}  // namespace misbench
