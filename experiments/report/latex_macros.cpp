#include <array>
#include <map>
#include <utility>
#include <vector>

#include "experiments/report/numbers.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/sha256.h"

namespace misbench {
namespace {

constexpr std::array kDigits{"Zero", "One", "Two",   "Three", "Four",
                             "Five", "Six", "Seven", "Eight", "Nine"};

// "veach-mis 0.5" to "VeachMisZeroPointFive": TeX's names have no other characters than letters.
std::string letters_of(std::string_view text) {
    std::string letters;
    bool starts_word = true;
    char before = ' ';
    for (const char c : text) {
        const bool is_upper = c >= 'A' && c <= 'Z';
        const bool is_lower = c >= 'a' && c <= 'z';
        const bool is_digit = c >= '0' && c <= '9';
        if (is_digit) {
            letters += kDigits[static_cast<std::size_t>(c - '0')];
        } else if (is_upper || is_lower) {
            letters += starts_word && is_lower ? static_cast<char>(c - 'a' + 'A') : c;
        } else if (c == '.' && before >= '0' && before <= '9') {
            letters += "Point";
        }
        starts_word = !is_upper && !is_lower;
        before = c;
    }
    return letters;
}

std::string five_letters_of(const std::string& key) {
    std::string letters;
    for (const char c : sha256_hex(key).substr(0, 5)) {
        letters += static_cast<char>('A' + (c <= '9' ? c - '0' : c - 'a' + 10));
    }
    return letters;
}

struct Macro {
    std::string key;  // exact, to tell names apart
    std::string name;
    std::string what;  // "Mean"
    std::string value;
};

std::string tex_number(const std::string& digits, int exponent) {
    return exponent == 0
               ? digits
               : "\\ensuremath{" + digits + "\\times 10^{" + std::to_string(exponent) + "}}";
}

void add_macros(std::vector<Macro>& macros, const Comparison& comparison, const ComparedCell& cell,
                std::optional<int> digits) {
    std::string key;
    std::string name;
    for (const std::string& part : {comparison.experiment, comparison.metric, cell.scene,
                                    cell.method, to_string(cell.budget)}) {
        key += part + '\n';
        name += letters_of(part);
    }
    const auto add = [&](const char* what, const NumberText& text) {
        for (const auto& [suffix, number] : {std::pair{"", text.value}, std::pair{"Low", text.low},
                                             std::pair{"High", text.high}}) {
            if (number.empty()) continue;
            macros.push_back(
                {key, name, std::string(what) + suffix, tex_number(number, text.exponent)});
        }
    };
    if (cell.mean) add("Mean", mean_text(*cell.mean, digits));
    if (cell.ratio) add("Ratio", ratio_text(*cell.ratio, digits));
}

}  // namespace

std::string to_latex_macros(std::span<const Comparison> comparisons, std::optional<int> digits) {
    std::vector<Macro> macros;
    for (const Comparison& comparison : comparisons) {
        for (const ComparedCell& cell : comparison.cells) {
            add_macros(macros, comparison, cell, digits);
        }
    }
    // Whole names, as a name may end like another one's number.
    std::map<std::string, std::map<std::string, int>> keys;
    for (const Macro& macro : macros) ++keys[macro.name + macro.what][macro.key];
    std::string tex;
    for (const Macro& macro : macros) {
        const bool is_shared = keys[macro.name + macro.what].size() > 1;
        tex += "\\newcommand{\\" + macro.name + (is_shared ? five_letters_of(macro.key) : "") +
               macro.what + "}{" + macro.value + "}\n";
    }
    return tex;
}

}  // namespace misbench
