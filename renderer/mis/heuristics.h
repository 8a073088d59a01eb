// A MIS heuristic is a weight function over the effective densities
//     q_k = n_k p_k(x)
// of all techniques k that could have produced the sample x. It takes densities and knows nothing
// of paths, so that it serves a renderer and an integral on [0, 1] alike.
//
// [Vea97]  E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace misbench {

struct MisHeuristic {
    std::string_view name;       // as written in an experiment; a number may follow: "power1.5"
    std::string_view formula;    // shown by `misbench list heuristics` and in reports
    std::string_view parameter;  // what the number is called, "" where none is taken
    double default_parameter;
    double min_parameter;  // exclusive bounds of the number
    double max_parameter;
    // In place: densities in units of the largest become shares u, w_s(x) = u_s / Σ_k u_k.
    void (*shares)(std::span<double> q, double parameter);
};

std::span<const MisHeuristic> heuristics();

// A heuristic with its number, for example from "power2".
class Heuristic {
 public:
    // Throws ParameterError("mis", …) with the list of what is known.
    static Heuristic parse(const std::string& text);
    // In place: all q[k] ≥ 0 and finite, one above 0, become shares u in [0, 1], the largest 1:
    // w_s(x) = u_s / Σ_k u_k. What multiplies a share multiplies the weight before all are made to
    // sum to one: u_k ∝ β_k q_k of hua2025 Eq. 17.
    void shares(std::span<double> q) const;
    // w_s(x) in [0, 1] for q[s] > 0.
    double weight(std::span<const double> q, std::size_t s) const;
    // The number always written: "power" parses as "power2".
    std::string canonical_name() const;

 private:
    Heuristic(const MisHeuristic* row, double parameter) : row_(row), parameter_(parameter) {}
    const MisHeuristic* row_;
    double parameter_;
};

}  // namespace misbench
