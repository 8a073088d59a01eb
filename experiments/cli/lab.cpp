// misbench lab: weights tried on integrals over an interval.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/lab/plot.h"
#include "experiments/lab/study_file.h"
#include "experiments/report/numbers.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

std::string with_technique_names(const lab::Problem& problem, const std::vector<double>& factors) {
    std::string text;
    for (std::size_t t = 0; t < factors.size(); ++t) {
        text +=
            fmt::format("{}{} {:.3g}", t == 0 ? "" : ", ", problem.techniques[t].name, factors[t]);
    }
    return text;
}

double exact_bias(const lab::Outcome& outcome, double integral) {
    const double bias = outcome.exact->mean - integral;
    // Of the quadrature, not of the estimator.
    constexpr double kRounding = 1e-9;
    return std::abs(bias) < kRounding * std::abs(outcome.exact->mean) ? 0 : bias;
}

std::vector<std::string> to_row(const lab::Problem& problem, const lab::Weighting& weighting,
                                const lab::Outcome& outcome, double integral) {
    return {
        weighting.name,
        outcome.exact ? fmt::format("{:.4g}", outcome.exact->variance) : "",
        outcome.sampled_variance ? format_mean(*outcome.sampled_variance) : "",
        outcome.exact ? fmt::format("{:.3g}", exact_bias(outcome, integral)) : "",
        outcome.sampled_bias ? format_mean(*outcome.sampled_bias) : "",
        outcome.error_ratio ? fmt::format("×{:.3g}", *outcome.error_ratio) : "",
        outcome.weights ? with_technique_names(problem, outcome.weights->factors) : "",
    };
}

std::string to_text(const lab::Case& of, const lab::CaseOutcome& outcome) {
    std::string text = fmt::format("{}: integral {:.6g}\n", of.problem.name, outcome.integral);
    Rows rows{{"weights", "variance", "sampled", "bias", "sampled", "error/balance", "factors"}};
    for (std::size_t i = 0; i < of.weightings.size(); ++i) {
        rows.push_back(to_row(of.problem, of.weightings[i], outcome.outcomes[i], outcome.integral));
    }
    text += align(rows);
    for (std::size_t i = 0; i < of.expectations.size(); ++i) {
        const lab::Expectation& expectation = of.expectations[i];
        const lab::Verdict& verdict = outcome.verdicts[i];
        text += fmt::format("{}: {} ({}){}{}\n", verdict.holds ? "holds" : "does not hold",
                            expectation.claim, verdict.found,
                            expectation.note.empty() ? "" : "; note: ", expectation.note);
    }
    return text;
}

// null for what is not there, and for infinity, which JSON does not know.
Json number_or_null(const std::optional<double>& number) {
    return number && std::isfinite(*number) ? Json(*number) : Json();
}

Json to_json(const std::optional<Estimate>& estimate) {
    if (!estimate) return {};
    Json json = {{"value", estimate->value}};
    if (estimate->interval) json["interval"] = {estimate->interval->low, estimate->interval->high};
    return json;
}

Json to_json(const lab::Problem& problem, const lab::Weighting& weighting,
             const lab::Outcome& outcome) {
    Json json = {{"weights", weighting.name},
                 {"exact", nullptr},
                 {"sampled_variance", to_json(outcome.sampled_variance)},
                 {"sampled_bias", to_json(outcome.sampled_bias)},
                 {"error", number_or_null(outcome.error)},
                 {"error_over_balance", number_or_null(outcome.error_ratio)}};
    if (outcome.exact) {
        json["exact"] = {{"mean", outcome.exact->mean},
                         {"variance", number_or_null(outcome.exact->variance)},
                         {"quadrature_error", number_or_null(outcome.exact->error)}};
    }
    if (outcome.weights && !outcome.weights->factors.empty()) {
        for (std::size_t t = 0; t < problem.techniques.size(); ++t) {
            json["factors"][problem.techniques[t].name] = outcome.weights->factors[t];
        }
    }
    return json;
}

Json to_json(const lab::Case& of, const lab::CaseOutcome& outcome) {
    Json json = {{"problem", of.problem.name},
                 {"description", of.problem.description},
                 {"integral", outcome.integral},
                 {"weights", Json::array()},
                 {"expectations", Json::array()}};
    for (std::size_t i = 0; i < of.weightings.size(); ++i) {
        json["weights"].push_back(to_json(of.problem, of.weightings[i], outcome.outcomes[i]));
    }
    for (std::size_t i = 0; i < of.expectations.size(); ++i) {
        json["expectations"].push_back({{"claim", of.expectations[i].claim},
                                        {"holds", outcome.verdicts[i].holds},
                                        {"found", outcome.verdicts[i].found},
                                        {"note", of.expectations[i].note}});
    }
    return json;
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string csv_number(const std::optional<double>& number) {
    return number ? fmt::format("{}", *number) : "";
}

std::string csv_estimate(const std::optional<Estimate>& estimate) {
    const bool has_interval = estimate && estimate->interval;
    return fmt::format("{},{},{}", estimate ? csv_number(estimate->value) : "",
                       has_interval ? csv_number(estimate->interval->low) : "",
                       has_interval ? csv_number(estimate->interval->high) : "");
}

std::string to_csv(const lab::Study& study, const std::vector<lab::CaseOutcome>& outcomes) {
    std::string csv =
        "problem,weights,integral,mean,variance,quadrature_error,sampled_variance,"
        "sampled_variance_low,sampled_variance_high,sampled_bias,sampled_bias_low,"
        "sampled_bias_high,error,error_over_balance\n";
    for (std::size_t c = 0; c < study.cases.size(); ++c) {
        const lab::Case& of = study.cases[c];
        for (std::size_t i = 0; i < of.weightings.size(); ++i) {
            const lab::Outcome& outcome = outcomes[c].outcomes[i];
            const bool has_exact = outcome.exact.has_value();
            csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_field(of.problem.name),
                               csv_field(of.weightings[i].name), outcomes[c].integral,
                               has_exact ? csv_number(outcome.exact->mean) : "",
                               has_exact ? csv_number(outcome.exact->variance) : "",
                               has_exact ? csv_number(outcome.exact->error) : "",
                               csv_estimate(outcome.sampled_variance),
                               csv_estimate(outcome.sampled_bias), csv_number(outcome.error),
                               csv_number(outcome.error_ratio));
        }
    }
    return csv;
}

}  // namespace

int lab_verb(const LabOptions& options) {
    if (!options.output.empty() && !options.output.ends_with(".svg")) {
        throw Error(Errc::InvalidArgument,
                    "output '" + options.output + "': the laboratory draws .svg only");
    }
    const lab::Study study = lab::read_study(options.file, options.overrides);
    std::vector<lab::CaseOutcome> outcomes;
    for (const lab::Case& one : study.cases) {
        outcomes.push_back(lab::examine(one, study.seed, study.runs));
    }
    if (!options.output.empty()) {
        write_file_durably(options.output, lab::to_svg(study, outcomes));
    }
    if (options.format == "csv") {
        print_result(to_csv(study, outcomes));
        return 0;
    }
    Json json = {{"study", study.name},
                 {"description", study.description},
                 {"seed", study.seed},
                 {"runs", study.runs},
                 {"problems", Json::array()}};
    std::string text;
    for (std::size_t c = 0; c < study.cases.size(); ++c) {
        json["problems"].push_back(to_json(study.cases[c], outcomes[c]));
        text += (c == 0 ? "" : "\n") + to_text(study.cases[c], outcomes[c]);
    }
    print_result(options.format == "json" ? json.dump(2) + "\n" : text);
    return 0;
}

}  // namespace misbench
