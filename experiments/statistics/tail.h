// Whether rare seeds carry a method's error: then few seeds say little, and look as if they said
// much, for a mean is smallest just when the rare seeds are missing, and its spread with it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/statistics/intervals.h"

namespace misbench {

// A largest seed beyond this multiple of the median one is marked.
inline constexpr double kHeavyTail = 3;

// Largest over median value. Absent below kFewestForInterval values, and for a median that is not
// above zero.
std::optional<double> max_over_median(std::span<const double> values);

enum class TailVerdict {
    Calm,
    Heavy,      // marked: the interval stands
    Dishonest,  // no interval of these values is honest: none is shown
};
std::string to_string(TailVerdict verdict);  // "calm", "heavy", "dishonest"

// `kin` are values of the same method that have the same tail if they have one: other budgets of
// the same scene. Dishonest are the values when, of them and their kin, those beyond four times
// their median carry more than a fifth of the whole, and fewer than two of the values themselves
// lie there: the tail is known, its weight is not.
//
// What this does for the 95 % interval of a ratio to a calm method (lognormal, spread 0.2), in
// percent of 10 000 experiments: intervals that hold the truth when all are shown; then, without
// kin and with two budgets more, how many are withheld, and how many are shown and miss the truth.
// Errors are lognormal of spread 0.5, 0.8, 1.2, or calm but that a share of the seeds is that many
// times larger.
//
//                          all         alone          with kin
//     errors          n   cover   withheld  miss   withheld  miss
//     0.5             5    93.4       2      6.6       6      6.4
//     0.5            20    94.2       1      5.8       0      5.8
//     0.8             5    90.9      17      9.1      42      6.1
//     0.8            20    92.2      15      7.6      22      6.3
//     1.2             5    85.7      36     13.6      73      4.4
//     1.2            20    87.7      13     10.9      26      6.0
//     20 % of 5x      5    66.7      38     33.3      73     10.0
//     20 % of 5x     10    87.2      37     12.8      52      2.9
//     20 % of 5x     20    92.3       5      6.3      15      2.3
//     10 % of 10x    10    63.1      39     36.9      68      6.8
//     10 % of 10x    20    85.7      27     14.1      38      2.8
//     5 % of 50x     20    61.9      39     38.1      70      6.5
//     5 % of 50x     40    84.9      27     15.1      39      2.9
//
// Alone it cannot do more than warn: seeds that all miss a spike (a third of the experiments with 5
// seeds of which 20 % have one) look as calm as those of a method without. Only more seeds or kin
// show it.
TailVerdict judge_tail(std::span<const double> values,
                       std::span<const std::vector<double>> kin = {});

}  // namespace misbench
