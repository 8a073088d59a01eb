#include "renderer/weights/parameters.h"

#include <array>

#include "renderer/base/error.h"
#include "renderer/base/names.h"
#include "renderer/mis/heuristics.h"
#include "renderer/weights/jendersie.h"
#include "renderer/weights/popov.h"

namespace misbench {
namespace {

constexpr std::int64_t kMaxPasses = 1'000'000;

// To add a factor: write its provider, add its row. A parameter of its own goes into a struct with
// the provider's name in front of the parameters'.
constexpr std::array kFactors{
    FactorInfo{"correlation", "samples that share a prefix, by path densities: grittmann2021",
               [](const WeightParameters& p) { return make_correlation(p.correlation); }},
    FactorInfo{"popov", "samples that share a prefix count as one: Popov et al. 2015",
               [](const WeightParameters&) { return make_popov(); }},
    FactorInfo{"jendersie", "merging by footprints of both subpaths: Jendersie 2019",
               [](const WeightParameters&) { return make_jendersie(); }},
    FactorInfo{"variance", "each technique's second moment over its variance: grittmann2019",
               [](const WeightParameters& p) { return make_variance(p.variance); }},
    FactorInfo{"correction", "the best of a few factors by measured moments: hua2025",
               [](const WeightParameters& p) { return make_correction(p.correction); }},
};

}  // namespace

std::span<const FactorInfo> factor_infos() { return kFactors; }

void WeightParameters::check() {
    mis = Heuristic::parse(mis).canonical_name();
    check_range("training", training, std::int64_t{1}, kMaxPasses);
    check_range("precompute", precompute, std::int64_t{0}, kMaxPasses);
    correlation.check();
    variance.check();
    correction.check();
    const auto providers = make_factors(*this);
    for (std::size_t i = 0; i + 1 < providers.size(); ++i) {
        if (providers[i]->never_stops_learning()) {
            throw ParameterError("factors", "factors is '" + factors +
                                                "': none can learn after one that never stops");
        }
    }
}

std::vector<std::shared_ptr<FactorProvider>> make_factors(const WeightParameters& parameters) {
    std::vector<std::shared_ptr<FactorProvider>> providers;
    if (parameters.factors == "none") return providers;
    for (const std::string& name : split(parameters.factors, '+')) {
        providers.push_back(find_named(kFactors, name, "factors", "factor").make(parameters));
    }
    return providers;
}

}  // namespace misbench
