#include "experiments/report/report.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "experiments/analysis/comparison.h"
#include "experiments/plan/imported.h"
#include "experiments/report/claims_formats.h"
#include "experiments/report/doubts.h"
#include "experiments/report/page.h"
#include "experiments/report/provenance.h"
#include "experiments/report/report_data.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

// Where in the page the images come.
constexpr std::string_view kBlocksPlace = "{{blocks}}";

// The page with its {{placeholders}} replaced, in one pass: what is put in is not looked at again.
std::string fill(std::string_view page, const std::map<std::string, std::string>& values) {
    std::string filled;
    for (std::size_t at = 0; at < page.size();) {
        const std::size_t open = page.find("{{", at);
        filled += page.substr(at, open - at);
        if (open == std::string_view::npos) break;
        const std::size_t close = page.find("}}", open);
        filled += values.at(std::string(page.substr(open + 2, close - open - 2)));
        at = close + 2;
    }
    return filled;
}

std::string counted(std::size_t n, const std::string& what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

std::string list_to_html(const std::vector<std::string>& lines) {
    std::string html = "<ul>\n";
    for (const std::string& line : lines) html += "<li>" + escape_html(line) + "</li>\n";
    return html + "</ul>\n";
}

// Links that pick a scene or a method in the viewer.
std::string links_to_html(const std::string& what, const std::vector<std::string>& names) {
    std::string html;
    for (std::size_t i = 0; i < names.size(); ++i) {
        html += fmt::format("<li><a href=\"#images\" data-{}=\"{}\">{}</a></li>\n", what, i,
                            escape_html(names[i]));
    }
    return html;
}

std::string parameters_to_html(const ParameterMap& parameters) {
    std::string html;
    for (const auto& [name, value] : parameters) {
        html +=
            fmt::format("<code>{}={}</code> ", escape_html(name), escape_html(to_string(value)));
    }
    return html;
}

nlohmann::ordered_json running_to_json(const std::optional<Running>& running) {
    if (!running) return nullptr;
    return {{"tasks", running->n_tasks},
            {"done", running->n_done},
            {"failed", running->n_failed},
            {"reload_seconds", running->reload_seconds}};
}

class Reporter {
 public:
    Reporter(const Store& store, const Plan& plan)
        : store_(store),
          plan_(plan),
          comparison_(compare(store, plan)),
          origins_(store.origins(plan.experiment)) {}

    Report report(const ReportContents& contents) const {
        ReportImages images =
            collect_images(store_, plan_, comparison_, contents.seeds, contents.precision);
        nlohmann::ordered_json data = report_data(store_, plan_);
        data["images"] = std::move(images.images);
        data["blocks"] = std::move(images.blocks);
        data["running"] = running_to_json(contents.running);
        const std::size_t n_images = data["images"].size();
        // The pixels are by far the most of it: they are never copied.
        const std::string_view page = kPage;
        const std::size_t at = page.find(kBlocksPlace);
        std::string html = std::move(images.html);
        html += page.substr(at + kBlocksPlace.size());
        html.insert(0, fill(page.substr(0, at), values(data, n_images, contents)));
        return {.html = std::move(html), .n_images = n_images};
    }

 private:
    std::map<std::string, std::string> values(const nlohmann::ordered_json& data,
                                              std::size_t n_images,
                                              const ReportContents& contents) const {
        std::vector<std::string> scenes;
        for (const PlannedScene& scene : plan_.scenes) scenes.push_back(scene.name);
        return {{"name", escape_html(plan_.experiment)},
                {"style", kPageStyle},
                {"script", kPageScript},
                {"charts", kChartLibrary},
                {"description", escape_html(plan_.description)},
                {"extent", escape_html(extent(n_images, contents))},
                {"scene-links", links_to_html("scene", scenes)},
                {"method-links", links_to_html("method", plan_.methods)},
                {"claims", claims()},
                {"tables", tables()},
                {"methods", methods()},
                {"doubts", doubts_to_html()},
                {"provenance", provenance()},
                {"configuration", configuration()},
                {"data", embedded_json(data)}};
    }

    std::string extent(std::size_t n_images, const ReportContents& contents) const {
        std::string budgets;
        for (const Budget& budget : plan_.budgets) {
            budgets += (budgets.empty() ? "" : ", ") + to_string(budget);
        }
        return fmt::format(
            "{}, {}; {}; {}; {} in {} precision", counted(plan_.scenes.size(), "scene"),
            counted(plan_.methods.size(), "method"), budgets, counted(plan_.cells.size(), "cell"),
            counted(n_images, "image"), to_string(contents.precision));
    }

    std::string claims() const {
        if (plan_.claims.empty()) return "";
        return "<section id=\"claims\">\n<h2>Claims</h2>\n<div class=\"scroll\">" +
               claims_to_html({plan_.experiment, judge_claims(store_, plan_)}) +
               "</div>\n</section>\n";
    }

    // The first metric's table is open, those of further metrics are folded.
    std::string tables() const {
        std::string html;
        for (std::size_t i = 0; i < plan_.metrics.size(); ++i) {
            const Table table = make_table(compare(store_, plan_, plan_.metrics[i]), {}, {});
            html += fmt::format(
                "<details data-metric=\"{}\"{}><summary>{}</summary>\n<div class=\"scroll\">{}"
                "</div></details>\n",
                i, i == 0 ? " open" : "", escape_html(table.title), to_html(table));
        }
        return html;
    }

    // What all of them have in common, the reference too, is said once, below.
    std::string methods() const {
        const auto configuration = nlohmann::json::parse(plan_.configuration);
        const nlohmann::json& reference = configuration.at("reference");
        ParameterMap shared = parameters_from_json(reference.at("parameters"));
        for (const std::string& label : plan_.methods) {
            const ParameterMap own =
                parameters_from_json(configuration.at("methods").at(label).at("parameters"));
            std::erase_if(shared, [&own](const auto& parameter) {
                const auto found = own.find(parameter.first);
                return found == own.end() || found->second != parameter.second;
            });
        }
        std::string html =
            "<div class=\"scroll\"><table>\n<thead><tr><th>label</th><th>method</th>"
            "<th>parameters</th></tr></thead>\n<tbody>\n";
        const auto add_row = [&](const std::string& label, const nlohmann::json& method) {
            ParameterMap own = parameters_from_json(method.at("parameters"));
            std::erase_if(own, [&shared](const auto& parameter) {
                const auto found = shared.find(parameter.first);
                return found != shared.end() && found->second == parameter.second;
            });
            const std::string name = method.at("method");
            html += fmt::format(
                "<tr><th>{}</th><td>{}</td><td>{}</td></tr>\n", escape_html(label),
                name.starts_with(imported_method(""))
                    ? "imported images"
                    : escape_html(fmt::format("{} v{}", name, method.at("version").get<int>())),
                parameters_to_html(own));
        };
        for (const std::string& label : plan_.methods) {
            add_row(label, configuration.at("methods").at(label));
        }
        add_row("reference", reference);
        html += "</tbody></table></div>\n";
        if (shared.empty()) return html;
        return html + "<p class=\"hint\">In all of them: " + parameters_to_html(shared) + "</p>\n";
    }

    std::string doubts_to_html() const {
        std::string html;
        for (const auto& [kind, cases] : doubts(store_, plan_, comparison_)) {
            html += fmt::format("<details><summary>{}: {}</summary>\n{}</details>\n",
                                escape_html(kind), cases.size(), list_to_html(cases));
        }
        return html.empty() ? "<p>Nothing to warn of.</p>\n" : html;
    }

    std::string provenance() const {
        std::string html =
            "<div class=\"scroll\"><table>\n<thead><tr><th>machine</th><th>threads</th>"
            "<th>build</th><th>compiler</th><th>flags</th><th>runs</th></tr></thead>\n<tbody>\n";
        for (const auto& [from, threads, n_runs] : origins_) {
            if (from.cpu_model.empty()) {
                html += fmt::format(
                    "<tr><td>imported images</td><td></td><td colspan=\"3\">renderer: {}</td>"
                    "<td>{}</td></tr>\n",
                    escape_html(from.build_id), n_runs);
                continue;
            }
            html += fmt::format(
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td><code>{}</code></td>"
                "<td>{}</td></tr>\n",
                escape_html(fmt::format("{} ({}, {})", from.cpu_model, from.isa, from.host)),
                threads, escape_html(from.build_id), escape_html(from.compiler),
                escape_html(from.flags), n_runs);
        }
        html += "</tbody></table></div>\n";
        std::vector<std::string> lines = disturbance_lines(store_, plan_);
        for (std::string& line : provenance_warnings(store_, plan_.experiment)) {
            lines.push_back(std::move(line));
        }
        return html + list_to_html(lines);
    }

    std::string configuration() const {
        return escape_html(nlohmann::ordered_json::parse(plan_.configuration).dump(2));
    }

    const Store& store_;
    const Plan& plan_;
    Comparison comparison_;
    std::vector<Origin> origins_;
};

}  // namespace

Report make_report(const Store& store, const Plan& plan, const ReportContents& contents) {
    try {
        return Reporter(store, plan).report(contents);
    } catch (const nlohmann::json::exception& e) {
        throw Error(Errc::DataLoss,
                    "read the configuration of experiment '" + plan.experiment + "': " + e.what());
    }
}

}  // namespace misbench
