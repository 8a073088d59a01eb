#include "experiments/report/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace misbench {
namespace {

constexpr int kMaxDecimals = 9;

int exponent_of(double value) {
    return value == 0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value))));
}

// Decimals with which `value` shows `digits` significant digits.
int decimals_for(double value, int digits) {
    return std::clamp(digits - 1 - exponent_of(value), 0, kMaxDecimals);
}

double half_width(const Interval& interval) { return (interval.high - interval.low) / 2; }

// Ranges of code points that take two columns or none, for what occurs in names.
int columns_of(std::uint32_t c) {
    const auto within = [c](std::uint32_t first, std::uint32_t last) {
        return c >= first && c <= last;
    };
    if (within(0x300, 0x36F) || within(0x200B, 0x200D) || within(0xFE00, 0xFE0F)) return 0;
    const bool wide = within(0x1100, 0x115F) || within(0x2E80, 0xA4CF) || within(0xAC00, 0xD7A3) ||
                      within(0xF900, 0xFAFF) || within(0xFE30, 0xFE6F) || within(0xFF00, 0xFF60) ||
                      within(0x1F300, 0x1FAFF) || within(0x20000, 0x3FFFD);
    return wide ? 2 : 1;
}

}  // namespace

NumberText mean_text(const Estimate& mean, std::optional<int> digits) {
    NumberText text;
    text.exponent = exponent_of(mean.value);
    const bool scientific = text.exponent < -4 || text.exponent > 5;
    if (!scientific) text.exponent = 0;
    const double scale = scientific ? std::pow(10.0, text.exponent) : 1.0;
    const double value = mean.value / scale;
    const double half = mean.interval ? half_width(*mean.interval) / scale : 0;
    int decimals = mean.interval ? decimals_for(half, 2) : decimals_for(value, 3);
    if (digits) decimals = decimals_for(value, *digits);
    text.value = fmt::format("{:.{}f}", value, decimals);
    if (!mean.interval) return text;
    text.half = fmt::format("{:.{}f}", half, decimals);
    text.low = fmt::format("{:.{}f}", mean.interval->low / scale, decimals);
    text.high = fmt::format("{:.{}f}", mean.interval->high / scale, decimals);
    return text;
}

NumberText ratio_text(const Estimate& ratio, std::optional<int> digits) {
    NumberText text;
    if (!ratio.interval) {
        text.value =
            fmt::format("{:.{}f}", ratio.value, decimals_for(ratio.value, digits.value_or(3)));
        return text;
    }
    const auto [low, high] = *ratio.interval;
    int decimals = std::max(decimals_for(half_width(*ratio.interval), 2), decimals_for(low, 2));
    if (digits) decimals = decimals_for(ratio.value, *digits);
    // A bound beyond 1 must not be rounded to it.
    const auto is_one = [&decimals](double bound) {
        return std::abs(bound - 1) < 0.5 * std::pow(10.0, -decimals);
    };
    while (excludes_one(ratio) && decimals < kMaxDecimals && (is_one(low) || is_one(high))) {
        ++decimals;
    }
    text.value = fmt::format("{:.{}f}", ratio.value, decimals);
    text.low = fmt::format("{:.{}f}", low, decimals);
    text.high = fmt::format("{:.{}f}", high, decimals);
    return text;
}

std::string format_mean(const Estimate& mean, std::optional<int> digits) {
    const NumberText text = mean_text(mean, digits);
    if (text.half.empty()) {
        return text.exponent == 0 ? text.value : fmt::format("{}e{}", text.value, text.exponent);
    }
    const std::string both = text.value + " ± " + text.half;
    return text.exponent == 0 ? both : fmt::format("({})e{}", both, text.exponent);
}

std::string format_ratio(const Estimate& ratio, std::optional<int> digits) {
    const NumberText text = ratio_text(ratio, digits);
    if (text.low.empty()) return "×" + text.value;
    return fmt::format("×{} [{}, {}]", text.value, text.low, text.high);
}

std::string format_duration(double seconds) {
    const auto whole = static_cast<std::int64_t>(std::llround(std::max(0.0, seconds)));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::size_t display_width(std::string_view utf8) {
    int width = 0;
    std::uint32_t code_point = 0;
    int n_following = 0;
    for (const char c : utf8) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xC0U) == 0x80U) {
            code_point = (code_point << 6U) | (byte & 0x3FU);
            if (--n_following == 0) width += columns_of(code_point);
        } else if (byte < 0x80U) {
            ++width;
        } else {
            n_following = byte >= 0xF0U ? 3 : byte >= 0xE0U ? 2 : 1;
            code_point = byte & (0x3FU >> n_following);
        }
    }
    return static_cast<std::size_t>(width);
}

std::string padded(std::string_view utf8, std::size_t width) {
    std::string text(utf8);
    const std::size_t used = display_width(utf8);
    if (used < width) text.append(width - used, ' ');
    return text;
}

}  // namespace misbench
