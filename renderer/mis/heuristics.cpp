#include "renderer/mis/heuristics.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "renderer/base/check.h"
#include "renderer/base/names.h"
#include "renderer/base/parameters.h"

namespace misbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// To add a heuristic: write its w_s below, add its row to kHeuristics. Nothing else: parsing,
// `misbench list`, reports and the property tests all walk this table.
//
// All rows divide by q_s first: q spans more decades than a double, its powers more still, but a
// technique whose ratio to q_s overflows leaves a weight of 0, which is right. All four are
// [Vea97]'s, chapter 9.

// w_s = q_s / Σ_k q_k
double balance(std::span<const double> q, std::size_t s, double /*unused*/) {
    double sum = 0;
    for (const double q_k : q) sum += q_k / q[s];
    return 1 / sum;
}

// w_s = q_s^β / Σ_k q_k^β
double power(std::span<const double> q, std::size_t s, double beta) {
    double sum = 0;
    for (const double q_k : q) {
        const double ratio = q_k / q[s];
        sum += beta == 2 ? ratio * ratio : std::pow(ratio, beta);
    }
    return 1 / sum;
}

// The first of the largest, so that ties are given once.
std::size_t argmax(std::span<const double> q) {
    return static_cast<std::size_t>(std::max_element(q.begin(), q.end()) - q.begin());
}

// w_s = 1 where q_s is the largest, else 0
double maximum(std::span<const double> q, std::size_t s, double /*unused*/) {
    return argmax(q) == s ? 1 : 0;
}

// w_s = q_s / Σ {q_k : q_k ≥ α q_max} where q_s ≥ α q_max, else 0
double cutoff(std::span<const double> q, std::size_t s, double alpha) {
    const double threshold = alpha * q[argmax(q)];
    if (q[s] < threshold) return 0;
    double sum = 0;
    for (const double q_k : q) {
        if (q_k >= threshold) sum += q_k / q[s];
    }
    return 1 / sum;
}

constexpr std::array kHeuristics{
    MisHeuristic{"balance", "q_s / Σ q_k", "", 0, 0, 0, balance},
    MisHeuristic{"power", "q_s^β / Σ q_k^β", "β", 2, 0, kInfinity, power},
    MisHeuristic{"maximum", "1 where q_s = max q_k, else 0", "", 0, 0, 0, maximum},
    MisHeuristic{"cutoff", "balance over the q_k ≥ α max q_k", "α", 0.1, 0, 1, cutoff},
};

[[noreturn]] void throw_unknown(const std::string& text) {
    throw ParameterError("mis", "unknown MIS heuristic '" + text +
                                    "'; known:" + known_names(kHeuristics) +
                                    "; power and cutoff may have a number, such as power1.5");
}

}  // namespace

std::span<const MisHeuristic> heuristics() { return kHeuristics; }

Heuristic Heuristic::parse(const std::string& text) {
    const auto* row = std::find_if(
        kHeuristics.begin(), kHeuristics.end(),
        [&text](const MisHeuristic& candidate) { return text.starts_with(candidate.name); });
    if (row == kHeuristics.end()) throw_unknown(text);
    const std::string_view number = std::string_view(text).substr(row->name.size());
    if (number.empty()) return {row, row->default_parameter};
    double value = 0;
    const auto [end, status] = std::from_chars(number.data(), number.data() + number.size(), value);
    const bool read = status == std::errc() && end == number.data() + number.size();
    if (row->parameter.empty() || !read) throw_unknown(text);
    if (!(value > row->min_parameter && value < row->max_parameter)) {
        const bool bounded = row->max_parameter < kInfinity;
        throw ParameterError(
            "mis", "MIS heuristic '" + text + "': " + std::string(row->parameter) +
                       " must be above " + to_string(row->min_parameter) +
                       (bounded ? " and below " + to_string(row->max_parameter) : " and finite"));
    }
    return {row, value};
}

std::string Heuristic::canonical_name() const {
    std::string name(row_->name);
    if (!row_->parameter.empty()) {
        std::string number = to_string(parameter_);
        if (number.ends_with(".0")) number.resize(number.size() - 2);
        name += number;
    }
    return name;
}

}  // namespace misbench
