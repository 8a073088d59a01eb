// p values of many tests at once, adjusted so that each can be held against one level.
//
// [BH95]   Y. Benjamini, Y. Hochberg, Controlling the False Discovery Rate, JRSS B 57(1), 1995.
// [Holm79] S. Holm, A Simple Sequentially Rejective Multiple Test Procedure, Scandinavian Journal
//          of Statistics 6(2), 1979.
#pragma once

#include <span>
#include <vector>

namespace misbench {

// In the order given. Of the tests whose adjusted p is at most α, a share of α at most is expected
// to be false, if the tests are independent or positively dependent, as those of many methods
// against one baseline are.  [BH95]
// REQUIRES: every p in [0, 1], and of tests alone: a cell that has none is left out, for it would
// count as one more test.
std::vector<double> benjamini_hochberg(std::span<const double> p);

// The same, but that one of them is false at all has probability α at most, however the tests
// depend on each other.  [Holm79]
std::vector<double> holm(std::span<const double> p);

}  // namespace misbench
