// Numbers as people read them: as many digits as the interval supports, and widths on a terminal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "experiments/statistics/intervals.h"

namespace misbench {

// "0.0123 ± 0.0011", "(1.23 ± 0.11)e-7"; without an interval three digits: "0.0123".
// `digits` asks for that many significant ones of the value instead.
std::string format_mean(const Estimate& mean, std::optional<int> digits = {});

// "×0.54 [0.50, 0.58]"; without an interval "×0.54".
std::string format_ratio(const Estimate& ratio, std::optional<int> digits = {});

// The same digits, one by one; empty where there is no interval.
struct NumberText {
    std::string value;
    std::string half;  // of the interval's length; of means only
    std::string low;
    std::string high;
    int exponent = 0;  // of ten, that all are multiplied by
};
NumberText mean_text(const Estimate& mean, std::optional<int> digits = {});
NumberText ratio_text(const Estimate& ratio, std::optional<int> digits = {});

// "12 s", "3 min 20 s", "2 h 5 min".
std::string format_duration(double seconds);

// Columns that UTF-8 text takes on a terminal.
std::size_t display_width(std::string_view utf8);

// The text, filled up with spaces to `width` columns.
std::string padded(std::string_view utf8, std::size_t width);

}  // namespace misbench
