// misbench tradeoff: what accuracy costs, in time, in samples or by a parameter.
#include <map>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/tradeoff_formats.h"

namespace misbench {
namespace {

std::string printed(const Tradeoff& tradeoff, const std::string& format) {
    if (format == "csv") return tradeoff_to_csv(tradeoff);
    if (format == "json") return tradeoff_to_json(tradeoff);
    return format == "markdown" ? tradeoff_to_markdown(tradeoff) : tradeoff_to_text(tradeoff);
}

std::string printed(const ParameterTradeoff& tradeoff, const std::string& format) {
    if (format == "csv") return ladders_to_csv(tradeoff);
    if (format == "json") return ladders_to_json(tradeoff);
    return format == "markdown" ? ladders_to_markdown(tradeoff) : ladders_to_text(tradeoff);
}

}  // namespace

int tradeoff_verb(const TradeoffOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    const Plan plan = store.experiment(options.experiment);
    const TradeoffQuestion question{.metric = options.y,
                                    .scene = options.scene,
                                    .against = options.against,
                                    .target = options.target};
    const std::map<std::string, Effort> efforts = {
        {"cost", Effort::Cpu}, {"wall", Effort::Wall}, {"passes", Effort::Passes}};
    if (const auto effort = efforts.find(options.x); effort != efforts.end()) {
        print_result(printed(tradeoff(store, plan, effort->second, question), options.format));
        return 0;
    }
    const ParameterTradeoff by_parameter = parameter_tradeoff(store, plan, options.x, question);
    if (by_parameter.ladders.empty()) print_note("no two methods that differ in it are measured");
    print_result(printed(by_parameter, options.format));
    return 0;
}

}  // namespace misbench
