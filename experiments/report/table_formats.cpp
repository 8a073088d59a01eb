#include "experiments/report/table_formats.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "experiments/report/numbers.h"

namespace misbench {
namespace {

constexpr std::string_view kColumnGap = "   ";

using Style = std::string (*)(const std::string&);
std::string as_it_is(const std::string& text) { return text; }

// The lines of a cell that are not empty; a ratio that differs in bold.
std::vector<std::string> lines_of(const TableCell& cell, Style escape = as_it_is,
                                  Style bold = as_it_is) {
    std::vector<std::string> lines;
    for (const std::string* line : {&cell.mean, &cell.ratio, &cell.status}) {
        if (line->empty()) continue;
        const bool is_bold = line == &cell.ratio && cell.verdict != Verdict::None;
        lines.push_back(is_bold ? bold(escape(*line)) : escape(*line));
    }
    return lines;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
    std::string text;
    for (const std::string& part : parts) {
        if (&part != &parts.front()) text += separator;
        text += part;
    }
    return text;
}

std::string replace_characters(std::string_view text,
                               const std::map<std::string_view, std::string_view>& replacements) {
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t length = 1;
        while (i + length < text.size() &&
               (static_cast<unsigned char>(text[i + length]) & 0xC0U) == 0x80U) {
            ++length;
        }
        const std::string_view character = text.substr(i, length);
        const auto replacement = replacements.find(character);
        result += replacement == replacements.end() ? character : replacement->second;
        i += length;
    }
    return result;
}

// Every line of text of the table as cells of one grid: the header, then up to three per row.
std::vector<std::vector<std::string>> grid_of(const Table& table) {
    std::vector<std::vector<std::string>> grid{table.label_headers};
    grid.front().insert(grid.front().end(), table.columns.begin(), table.columns.end());
    for (const TableRow& row : table.rows) {
        std::size_t height = 1;
        for (const TableCell& cell : row.cells) height = std::max(height, lines_of(cell).size());
        for (std::size_t line = 0; line < height; ++line) {
            auto& out = grid.emplace_back();
            for (const std::string& label : row.labels) out.push_back(line == 0 ? label : "");
            for (const TableCell& cell : row.cells) {
                const auto lines = lines_of(cell);
                out.push_back(line < lines.size() ? lines[line] : "");
            }
        }
    }
    return grid;
}

void strip_trailing_spaces(std::string& text) { text.erase(text.find_last_not_of(' ') + 1); }

constexpr std::string_view class_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::Better:
            return "better";
        case Verdict::Worse:
            return "worse";
        case Verdict::Different:
            return "different";
        case Verdict::None:
            break;
    }
    return "";
}

std::string html_span(std::string_view css_class, const std::string& text, bool is_bold = false) {
    if (text.empty()) return "";
    const std::string escaped = is_bold ? "<b>" + escape_html(text) + "</b>" : escape_html(text);
    return "<span class=\"" + std::string(css_class) + "\">" + escaped + "</span>";
}

}  // namespace

std::string escape_html(std::string_view text) {
    return replace_characters(
        text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}});
}

std::string escape_latex(std::string_view text) {
    return replace_characters(text, {{"&", "\\&"},
                                     {"%", "\\%"},
                                     {"$", "\\$"},
                                     {"#", "\\#"},
                                     {"_", "\\_"},
                                     {"{", "\\{"},
                                     {"}", "\\}"},
                                     {"~", "\\textasciitilde{}"},
                                     {"^", "\\textasciicircum{}"},
                                     {"\\", "\\textbackslash{}"},
                                     {"<", "$<$"},
                                     {">", "$>$"},
                                     {"[", "{[}"},
                                     {"]", "{]}"},
                                     {"±", "$\\pm$"},
                                     {"×", "$\\times$"},
                                     {"▼", "$\\downarrow$"},
                                     {"▲", "$\\uparrow$"},
                                     {"≤", "$\\le$"},
                                     {"†", "\\dag{}"},
                                     {"‡", "\\ddag{}"},
                                     {"§", "\\S{}"},
                                     {"–", "--"}});
}

std::string escape_markdown(std::string_view text) {
    return replace_characters(text, {{"|", "\\|"}, {"*", "\\*"}, {"_", "\\_"}, {"<", "&lt;"}});
}

std::string to_text(const Table& table) {
    const auto grid = grid_of(table);
    std::vector<std::size_t> widths(grid.front().size());
    for (const auto& line : grid) {
        for (std::size_t c = 0; c < line.size(); ++c) {
            widths[c] = std::max(widths[c], display_width(line[c]));
        }
    }
    std::string text = table.title + "\n\n";
    for (const auto& line : grid) {
        // A row that starts with its label stands apart from the one above.
        if (&line != &grid.front() && !line.front().empty()) text += "\n";
        std::string out;
        for (std::size_t c = 0; c < line.size(); ++c) {
            if (c > 0) out += kColumnGap;
            out += padded(line[c], widths[c]);
        }
        strip_trailing_spaces(out);
        text += out + "\n";
    }
    text += "\n";
    for (const std::string& line : table.footer) text += line + "\n";
    return text;
}

std::string to_markdown(const Table& table) {
    std::string text = "**" + escape_markdown(table.title) + "**\n\n|";
    for (const auto& header : table.label_headers) text += " " + escape_markdown(header) + " |";
    for (const auto& header : table.columns) text += " " + escape_markdown(header) + " |";
    text += "\n|";
    for (std::size_t c = 0; c < table.label_headers.size(); ++c) text += "---|";
    for (std::size_t c = 0; c < table.columns.size(); ++c) text += "---:|";
    text += "\n";
    for (const TableRow& row : table.rows) {
        text += "|";
        for (const std::string& label : row.labels) text += " " + escape_markdown(label) + " |";
        for (const TableCell& cell : row.cells) {
            const auto lines = lines_of(
                cell, [](const std::string& line) { return escape_markdown(line); },
                [](const std::string& line) { return "**" + line + "**"; });
            text += " " + join(lines, "<br>") + " |";
        }
        text += "\n";
    }
    text += "\n";
    for (const std::string& line : table.footer) text += escape_markdown(line) + "  \n";
    return text;
}

std::string to_latex(const Table& table) {
    std::string text = "% " + table.title + "\n";
    for (const std::string& line : table.footer) text += "% " + line + "\n";
    text += "% needs \\usepackage{booktabs}\n\\begin{tabular}{";
    text += std::string(table.label_headers.size(), 'l') + std::string(table.columns.size(), 'r');
    text += "}\n\\toprule\n";
    std::vector<std::string> cells;
    for (const auto& header : table.label_headers) cells.push_back(escape_latex(header));
    for (const auto& header : table.columns) cells.push_back(escape_latex(header));
    text += join(cells, " & ") + " \\\\\n\\midrule\n";
    for (const TableRow& row : table.rows) {
        cells.clear();
        for (const std::string& label : row.labels) cells.push_back(escape_latex(label));
        for (const TableCell& cell : row.cells) {
            const auto lines = lines_of(
                cell, [](const std::string& line) { return escape_latex(line); },
                [](const std::string& line) { return "\\textbf{" + line + "}"; });
            cells.push_back(lines.size() < 2 ? join(lines, "")
                                             : "\\shortstack[r]{" + join(lines, "\\\\") + "}");
        }
        text += join(cells, " & ") + " \\\\\n";
    }
    return text + "\\bottomrule\n\\end{tabular}\n";
}

std::string to_html(const Table& table) {
    std::string html = "<table class=\"comparison\">\n<thead><tr>";
    for (const auto& header : table.label_headers) html += "<th>" + escape_html(header) + "</th>";
    for (const auto& header : table.columns) html += "<th>" + escape_html(header) + "</th>";
    html += "</tr></thead>\n<tbody>\n";
    for (const TableRow& row : table.rows) {
        html += "<tr>";
        for (const auto& label : row.labels) html += "<th>" + escape_html(label) + "</th>";
        for (const TableCell& cell : row.cells) {
            html += "<td class=\"" + std::string(class_of(cell.verdict)) + "\">" +
                    html_span("mean", cell.mean) +
                    html_span("ratio", cell.ratio, cell.verdict != Verdict::None) +
                    html_span("status", cell.status) + html_span("effort", cell.effort) + "</td>";
        }
        html += "</tr>\n";
    }
    html += "</tbody></table>\n<ul class=\"footer\">\n";
    for (const std::string& line : table.footer) html += "<li>" + escape_html(line) + "</li>\n";
    return html + "</ul>\n";
}

}  // namespace misbench
