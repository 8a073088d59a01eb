// Integrals of several functions at once, adaptively and with a checked error.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace misbench::lab {

// Writes the values of all functions at x.
using Functions = std::function<void(double x, std::span<double> values)>;

struct Integrals {
    std::vector<std::vector<double>> pieces;  // [between two edges][function]
    std::vector<double> errors;               // [function], summed over all pieces: a bound
    // False where the functions seem to have no finite integral: a pole in a piece.
    bool converged = true;

    double total(std::size_t function) const;
};

// Gauss and Kronrod's rule of 7 and 15 points, halving what is not good enough to 1e-10 of the
// functions' absolute integrals. Each piece is to be smooth but for few jumps at unknown places.
Integrals integrate(const Functions& functions, std::size_t n_functions,
                    std::span<const double> edges);

}  // namespace misbench::lab
