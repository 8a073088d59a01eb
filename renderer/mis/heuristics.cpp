#include "renderer/mis/heuristics.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "renderer/base/check.h"
#include "renderer/base/names.h"
#include "renderer/base/parameters.h"

namespace misbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// To add a heuristic: write its shares below, add its row to kHeuristics. Nothing else: parsing,
// `misbench list`, reports and the property tests all walk this table.
//
// Densities come in units of the largest: they span more decades than a double, their powers more
// still, but one that is lost beside the largest has a weight of 0, which is right. All but the
// last are [Vea97]'s, chapter 9.

// u_k = q_k
void balance(std::span<double> /*q*/, double /*unused*/) {}

// u_k = q_k^β
void power(std::span<double> q, double beta) {
    for (double& q_k : q) q_k = beta == 2 ? q_k * q_k : std::pow(q_k, beta);
}

// u_k = 1 for the first of the largest, so that ties are given once, else 0
void maximum(std::span<double> q, double /*unused*/) {
    const auto largest = std::max_element(q.begin(), q.end());
    for (auto q_k = q.begin(); q_k != q.end(); ++q_k) *q_k = q_k == largest ? 1 : 0;
}

// u_k = q_k where q_k ≥ α q_max, else 0
void cutoff(std::span<double> q, double alpha) {
    for (double& q_k : q) q_k = q_k < alpha ? 0 : q_k;
}

// u_k = 1 where q_k > 0, else 0
void constant(std::span<double> q, double /*unused*/) {
    for (double& q_k : q) q_k = q_k > 0 ? 1 : 0;
}

constexpr std::array kHeuristics{
    MisHeuristic{"balance", "q_s / Σ q_k", "", 0, 0, 0, balance},
    MisHeuristic{"power", "q_s^β / Σ q_k^β", "β", 2, 0, kInfinity, power},
    MisHeuristic{"maximum", "1 where q_s = max q_k, else 0", "", 0, 0, 0, maximum},
    MisHeuristic{"cutoff", "balance over the q_k ≥ α max q_k", "α", 0.1, 0, 1, cutoff},
    MisHeuristic{"constant", "1 / number of q_k > 0", "", 0, 0, 0, constant},
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

void Heuristic::shares(std::span<double> q) const {
    const double largest = *std::max_element(q.begin(), q.end());
    for (double& q_k : q) q_k /= largest;
    row_->shares(q, parameter_);
}

double Heuristic::weight(std::span<const double> q, std::size_t s) const {
    constexpr std::size_t kFew = 8;
    std::array<double, kFew> few;
    std::vector<double> many;
    if (q.size() > kFew) many.resize(q.size());
    const std::span u = q.size() > kFew ? std::span(many) : std::span(few).first(q.size());
    std::copy(q.begin(), q.end(), u.begin());
    shares(u);
    double sum = 0;
    for (const double u_k : u) sum += u_k;
    return u[s] / sum;
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
