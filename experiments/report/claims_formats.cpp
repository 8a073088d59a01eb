#include "experiments/report/claims_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/report/numbers.h"
#include "experiments/report/table_formats.h"

namespace misbench {
namespace {

// --- what all formats say ------------------------------------------------------------------------

std::string expected_of(const Claim& claim) {
    const double most = 1 + claim.margin;
    switch (claim.expect) {
        case Expectation::Less:
            return "less than 1";
        case Expectation::More:
            return "more than 1";
        case Expectation::NotMore:
            return fmt::format("at most {:.4g}", most);
        case Expectation::NotLess:
            return fmt::format("at least {:.4g}", 1 / most);
        case Expectation::Equal:
            break;
    }
    return fmt::format("{:.4g} to {:.4g}", 1 / most, most);
}

// "ours/correlation, relmse.eps0.01 at 30 s cpu, said to be less than 1".
std::string subject_of(const Claim& claim) {
    return fmt::format("{}/{}, {} at {}, said to be {}", claim.method, claim.against, claim.metric,
                       to_string(claim.budget), expected_of(claim));
}

// "VeachBidir", "worst of 4 scenes: VeachBidir", "mean of 4 scenes".
std::string scope_of(const ClaimFinding& found) {
    if (found.claim.over == ClaimOver::Each) return found.scene;
    const std::size_t n = found.claim.scenes.size();
    return fmt::format("{} of {} scene{}{}", to_string(found.claim.over), n, n == 1 ? "" : "s",
                       found.scene.empty() ? "" : ": " + found.scene);
}

std::string ours_of(const ClaimFinding& found) {
    if (!found.ratio) return "–";
    std::string ours = format_ratio(*found.ratio);
    if (found.few_passes) ours += " †";
    if (found.has_heavy_tail) ours += " ‡";
    return ours;
}

std::string paper_of(const ClaimFinding& found) {
    if (!found.paper) return "–";
    const std::optional<bool> agrees = found.agrees_with_paper();
    return fmt::format("×{:.4g}{}", *found.paper,
                       !agrees   ? ""
                       : *agrees ? ", within ours"
                                 : ", not within ours");
}

// What explains the finding, "" where nothing has to.
std::string remark_of(const ClaimFinding& found) {
    if (found.finding != Finding::NotDecided) return found.reason;
    if (found.more_seeds) {
        return fmt::format("{}{}about {} more seed{} may decide", found.reason,
                           found.reason.empty() ? "" : "; ", *found.more_seeds,
                           *found.more_seeds == 1 ? "" : "s");
    }
    return found.reason.empty() ? fmt::format("{} seeds would not decide", kMostSeeds)
                                : found.reason;
}

std::string seeds_of(const ClaimFinding& found) {
    return fmt::format("{} seed{}", found.n_seeds, found.n_seeds == 1 ? "" : "s");
}

std::string summary_of(const std::vector<ClaimFinding>& findings) {
    std::string summary;
    for (const Finding finding :
         {Finding::Reproduced, Finding::NotReproduced, Finding::NotDecided, Finding::NotMeasured}) {
        const auto n = std::ranges::count(findings, finding, &ClaimFinding::finding);
        if (n == 0) continue;
        summary += fmt::format("{}{} {}", summary.empty() ? "" : ", ", n, to_string(finding));
    }
    return summary;
}

std::vector<std::string> footer_of(const std::vector<ClaimFinding>& findings) {
    const auto percent = static_cast<int>(100 * kConfidence + 0.5);
    const auto is_paired = &ClaimFinding::is_paired;
    const bool some_paired = std::ranges::any_of(findings, is_paired);
    const bool some_unpaired = !std::ranges::all_of(findings, is_paired);
    std::vector<std::string> footer{
        fmt::format("× ratio of means [{} % log-delta-t interval, {}]; each finding is wrong for "
                    "at most {} % of experiments",
                    percent, kind_of_interval(some_paired, some_unpaired), 100 - percent)};
    if (std::ranges::any_of(findings, &ClaimFinding::few_passes)) {
        footer.push_back(few_passes_footnote());
    }
    if (std::ranges::any_of(findings, &ClaimFinding::has_heavy_tail)) {
        footer.push_back(heavy_tail_footnote());
    }
    return footer;
}

// Calls `visit` with the findings of one claim after the other.
void for_each_claim(const std::vector<ClaimFinding>& findings, const auto& visit) {
    for (auto first = findings.begin(); first != findings.end();) {
        const auto last = std::find_if(first, findings.end(), [&](const ClaimFinding& found) {
            return !(found.claim == first->claim);
        });
        visit(std::span(first, last));
        first = last;
    }
}

const char* class_of(Finding finding) {
    if (finding == Finding::Reproduced) return "better";
    return finding == Finding::NotReproduced ? "worse" : "";
}

nlohmann::ordered_json finding_to_json(const std::string& experiment, const ClaimFinding& found) {
    const auto or_null = [](const auto& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    nlohmann::ordered_json json = {{"experiment", experiment},
                                   {"claim", found.claim.text},
                                   {"where", found.claim.where},
                                   {"over", to_string(found.claim.over)},
                                   {"scene", found.scene},
                                   {"scenes", found.claim.scenes},
                                   {"method", found.claim.method},
                                   {"against", found.claim.against},
                                   {"metric", found.claim.metric},
                                   {"budget", to_string(found.claim.budget)},
                                   {"expect", to_string(found.claim.expect)},
                                   {"margin", found.claim.margin},
                                   {"paper", or_null(found.paper)}};
    json["ratio"] = nullptr;
    json["low"] = nullptr;
    json["high"] = nullptr;
    if (found.ratio) json["ratio"] = found.ratio->value;
    if (found.ratio && found.ratio->interval) {
        json["low"] = found.ratio->interval->low;
        json["high"] = found.ratio->interval->high;
    }
    json["agrees_with_paper"] = or_null(found.agrees_with_paper());
    json["seeds"] = found.n_seeds;
    json["is_paired"] = found.is_paired;
    json["heavy_tail"] = found.has_heavy_tail;
    json["few_passes"] = found.few_passes;
    json["finding"] = to_string(found.finding);
    json["reason"] = found.reason;
    json["more_seeds"] = or_null(found.more_seeds);
    json["note"] = found.claim.note;
    return json;
}

std::string csv_field(const nlohmann::ordered_json& value) {
    if (value.is_null()) return "";
    if (value.is_string()) return escape_csv(value.get<std::string>());
    if (!value.is_array()) return value.dump();
    std::string list;
    for (const auto& item : value) list += (list.empty() ? "" : " ") + item.get<std::string>();
    return escape_csv(list);
}

nlohmann::ordered_json all_to_json(const std::vector<ExperimentFindings>& experiments) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& [experiment, findings] : experiments) {
        for (const ClaimFinding& found : findings) {
            json.push_back(finding_to_json(experiment, found));
        }
    }
    return json;
}

}  // namespace

std::string claims_to_text(const std::vector<ExperimentFindings>& experiments) {
    std::string text;
    for (const auto& [experiment, findings] : experiments) {
        text += fmt::format("{}claims of {}: {}\n", text.empty() ? "" : "\n", experiment,
                            summary_of(findings));
        for_each_claim(findings, [&text](std::span<const ClaimFinding> lines) {
            const Claim& claim = lines.front().claim;
            text +=
                fmt::format("\n{}{}\n  {}\n", claim.text,
                            claim.where.empty() ? "" : " (" + claim.where + ")", subject_of(claim));
            std::vector<std::size_t> widths(4);
            std::vector<std::vector<std::string>> rows;
            for (const ClaimFinding& found : lines) {
                rows.push_back(
                    {to_string(found.finding), scope_of(found), ours_of(found),
                     found.paper ? "paper " + paper_of(found) : "",
                     seeds_of(found) + (remark_of(found).empty() ? "" : "; ") + remark_of(found)});
                for (std::size_t c = 0; c < widths.size(); ++c) {
                    widths[c] = std::max(widths[c], display_width(rows.back()[c]));
                }
            }
            for (const auto& row : rows) {
                for (std::size_t c = 0; c < row.size(); ++c) {
                    const std::size_t width = c < widths.size() ? widths[c] : 0;
                    if (c < widths.size() && width == 0) continue;
                    text += "  " + padded(row[c], width);
                }
                text += "\n";
            }
            if (!claim.note.empty()) text += "  note: " + claim.note + "\n";
        });
        text += "\n";
        for (const std::string& line : footer_of(findings)) text += line + "\n";
    }
    return text;
}

std::string claims_to_markdown(const std::vector<ExperimentFindings>& experiments) {
    std::string text;
    for (const auto& [experiment, findings] : experiments) {
        text += fmt::format(
            "{}**claims of {}: {}**\n\n"
            "| claim | where | ratio | scene | paper | ours | seeds | finding |\n"
            "|---|---|---|---|---:|---:|---:|---|\n",
            text.empty() ? "" : "\n", escape_markdown(experiment), summary_of(findings));
        for_each_claim(findings, [&text](std::span<const ClaimFinding> lines) {
            const Claim& claim = lines.front().claim;
            for (const ClaimFinding& found : lines) {
                const bool is_first = &found == &lines.front();
                const std::string remark = remark_of(found);
                std::string said = escape_markdown(claim.text);
                if (!claim.note.empty()) said += "<br>note: " + escape_markdown(claim.note);
                text +=
                    fmt::format("| {} | {} | {} | {} | {} | {} | {} | {}{} |\n",
                                is_first ? said : "", is_first ? escape_markdown(claim.where) : "",
                                is_first ? escape_markdown(subject_of(claim)) : "",
                                escape_markdown(scope_of(found)), paper_of(found), ours_of(found),
                                found.n_seeds, to_string(found.finding),
                                remark.empty() ? "" : "<br>" + escape_markdown(remark));
            }
        });
        text += "\n";
        for (const std::string& line : footer_of(findings)) text += escape_markdown(line) + "  \n";
    }
    return text;
}

std::string claims_to_html(const ExperimentFindings& experiment) {
    std::string html =
        "<table class=\"claims\">\n<thead><tr><th>claim</th><th>scene</th><th>paper</th>"
        "<th>ours</th><th>seeds</th><th>finding</th></tr></thead>\n<tbody>\n";
    for_each_claim(experiment.findings, [&html](std::span<const ClaimFinding> lines) {
        const Claim& claim = lines.front().claim;
        for (const ClaimFinding& found : lines) {
            html += "<tr>";
            if (&found == &lines.front()) {
                html += fmt::format("<th rowspan=\"{}\">{}", lines.size(), escape_html(claim.text));
                if (!claim.where.empty()) html += " (" + escape_html(claim.where) + ")";
                html += "<small>" + escape_html(subject_of(claim)) + "</small>";
                if (!claim.note.empty()) html += "<small>" + escape_html(claim.note) + "</small>";
                html += "</th>";
            }
            html += fmt::format(
                "<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"{}\">"
                "<span class=\"ratio\">{}</span><small>{}</small></td></tr>\n",
                escape_html(scope_of(found)), escape_html(paper_of(found)),
                escape_html(ours_of(found)), found.n_seeds, class_of(found.finding),
                to_string(found.finding), escape_html(remark_of(found)));
        }
    });
    html += "</tbody></table>\n<ul class=\"footer\">\n";
    for (const std::string& line : footer_of(experiment.findings)) {
        html += "<li>" + escape_html(line) + "</li>\n";
    }
    return html + "</ul>\n";
}

std::string claims_to_csv(const std::vector<ExperimentFindings>& experiments) {
    const nlohmann::ordered_json rows = all_to_json(experiments);
    const nlohmann::ordered_json header =
        rows.empty() ? finding_to_json("", ClaimFinding()) : rows.front();
    std::string csv;
    for (const auto& [name, value] : header.items()) csv += (csv.empty() ? "" : ",") + name;
    csv += "\n";
    for (const auto& row : rows) {
        std::string line;
        for (const auto& [name, value] : row.items()) {
            line += (line.empty() ? "" : ",") + csv_field(value);
        }
        csv += line + "\n";
    }
    return csv;
}

std::string claims_to_json(const std::vector<ExperimentFindings>& experiments) {
    return all_to_json(experiments).dump(2) + "\n";
}

}  // namespace misbench
