// What a method's weights are: a heuristic, and the factors in front of it with their parameters.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/paths/factor_provider.h"
#include "renderer/weights/correction.h"
#include "renderer/weights/correlation.h"
#include "renderer/weights/variance.h"

namespace misbench {

struct WeightParameters {
    std::string mis = "balance";
    std::string factors = "none";
    std::int64_t training = 1;
    std::int64_t precompute = 0;
    CorrelationParameters correlation = {};
    VarianceParameters variance = {};
    CorrectionParameters correction = {};

    static void fields(auto& self, auto&& field) {
        field("mis", self.mis, "heuristic that combines all techniques");
        field("factors", self.factors,
              "what multiplies the weights, in this order: names of `misbench list factors` joined "
              "by +, or none");
        field("training", self.training, "passes that each factor which learns is learned from");
        field("precompute", self.precompute,
              "passes before the image and outside of the budget to learn each from instead; 0: "
              "none");
        CorrelationParameters::fields(self.correlation, field);
        VarianceParameters::fields(self.variance, field);
        CorrectionParameters::fields(self.correction, field);
    }
    void check();
};

// A row of the table of factors.
struct FactorInfo {
    std::string_view name;     // as written in an experiment
    std::string_view summary;  // with its source
    std::shared_ptr<FactorProvider> (*make)(const WeightParameters&);
};
std::span<const FactorInfo> factor_infos();

// In the order of their names. Throws ParameterError("factors", …) with what is known.
std::vector<std::shared_ptr<FactorProvider>> make_factors(const WeightParameters& parameters);

}  // namespace misbench
