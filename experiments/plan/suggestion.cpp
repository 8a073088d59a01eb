#include "experiments/plan/suggestion.h"

#include <algorithm>
#include <cctype>

namespace misbench {
namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Edits (insert, remove, replace, swap two neighbours) between words, ignoring case.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            d[i][j] =
                std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                lower(a[i - 2]) == lower(b[j - 1])) {
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
            }
        }
    }
    return d[a.size()][b.size()];
}

}  // namespace

std::string unknown_name(std::string_view kind, const std::string& name,
                         const std::vector<std::string>& known) {
    std::string message = "unknown " + std::string(kind) + " '" + name + "'";
    const auto distance = [&name](const std::string& other) { return edit_distance(name, other); };
    const auto closest = std::ranges::min_element(known, {}, distance);
    const std::size_t close = name.size() < 2 ? 0 : std::max<std::size_t>(1, name.size() / 3);
    if (closest != known.end() && distance(*closest) <= close) {
        message += " (did you mean '" + *closest + "'?)";
    }
    message += "; known:";
    for (const std::string& other : known) message += " " + other;
    return message;
}

}  // namespace misbench
