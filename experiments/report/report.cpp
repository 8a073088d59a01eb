#include "experiments/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "experiments/analysis/comparison.h"
#include "experiments/report/claims_formats.h"
#include "experiments/report/numbers.h"
#include "experiments/report/page.h"
#include "experiments/report/provenance.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

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

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve(4 * ((bytes.size() + 2) / 3));
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group <<= 8U;
            if (i + k < bytes.size()) group |= static_cast<unsigned char>(bytes[i + k]);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool is_padding = i + k > bytes.size();
            text += is_padding ? '=' : kDigits[(group >> (18U - 6U * k)) & 63U];
        }
    }
    return text;
}

Image mean_of(const Image& a, const Image& b) {
    Image mean = a;
    for (std::size_t i = 0; i < mean.rgb.size(); ++i) mean.rgb[i] = (a.rgb[i] + b.rgb[i]) / 2;
    return mean;
}

// An image of the viewer, or the place where one is missing. `budget` is "" for the reference.
struct View {
    std::string method;
    std::string budget;
    std::string caption;
    std::optional<Image> image;
};

// Small images are shown magnified by a whole number.
constexpr int kShownWidth = 720;

std::string view_to_html(const View& view, double exposure, const Task& task) {
    const int magnification = std::max(1, (kShownWidth + task.width / 2) / task.width);
    const int width = magnification * task.width;
    const int height = magnification * task.height;
    const std::string content =
        view.image ? fmt::format(R"(<img alt="{}" width="{}" height="{}" src="data:image/png;)"
                                 R"(base64,{}">)",
                                 escape_html(view.method), width, height,
                                 base64(encode_png(*view.image, exposure)))
                   : fmt::format(R"(<div class="missing" style="width: {}px; height: {}px">)"
                                 "no finished run</div>",
                                 width, height);
    return fmt::format(
        "<figure data-method=\"{}\" data-budget=\"{}\">{}\n<figcaption>{}"
        "</figcaption></figure>\n",
        escape_html(view.method), escape_html(view.budget), content, escape_html(view.caption));
}

std::string buttons(const std::string& attribute, const std::vector<std::string>& names,
                    bool has_keys) {
    std::string html = "<nav>";
    for (std::size_t i = 0; i < names.size(); ++i) {
        html += fmt::format("<button type=\"button\" data-{}=\"{}\">", attribute,
                            escape_html(names[i]));
        if (has_keys && i < 10) html += fmt::format("<kbd>{}</kbd> ", i);
        html += escape_html(names[i]) + "</button>";
    }
    return html + "</nav>\n";
}

class Reporter {
 public:
    Reporter(const Store& store, const Plan& plan)
        : store_(store), plan_(plan), comparison_(compare(store, plan)) {}

    std::string report() const {
        const std::vector<std::string> from = provenance_lines(store_, plan_.experiment);
        return fill(kReport_html,
                    {{"name", escape_html(plan_.experiment)},
                     {"style", kReport_css},
                     {"script", kReport_js},
                     {"description", escape_html(plan_.description)},
                     {"extent", escape_html(extent())},
                     {"claims", claims()},
                     {"tables", tables(from)},
                     {"scenes", scenes()},
                     {"methods", methods()},
                     {"provenance", provenance(from)},
                     {"configuration",
                      escape_html(nlohmann::ordered_json::parse(plan_.configuration).dump(2))}});
    }

 private:
    std::string extent() const {
        std::string budgets;
        for (const Budget& budget : plan_.budgets) {
            budgets += (budgets.empty() ? "" : ", ") + to_string(budget);
        }
        return fmt::format("{} scenes, {} methods; {}; {} cells", plan_.scenes.size(),
                           plan_.methods.size(), budgets, plan_.cells.size());
    }

    std::string claims() const {
        if (plan_.claims.empty()) return "";
        return "<section>\n<h2>Claims</h2>\n<div class=\"scroll\">" +
               claims_to_html({plan_.experiment, judge_claims(store_, plan_)}) +
               "</div>\n</section>\n";
    }

    // The first metric's table is open, those of further metrics are folded.
    std::string tables(const std::vector<std::string>& provenance) const {
        std::string html;
        for (const std::string& metric : plan_.metrics) {
            const Table table = make_table(compare(store_, plan_, metric), {}, provenance);
            html += fmt::format(
                "<details{}><summary>{}</summary>\n<div class=\"scroll\">{}</div>"
                "</details>\n",
                html.empty() ? " open" : "", escape_html(table.title), to_html(table));
        }
        return html;
    }

    const Cell* find_cell(const std::string& scene, Role role) const {
        for (const Cell& cell : plan_.cells) {
            if (cell.scene == scene && cell.role == role) return &cell;
        }
        return nullptr;
    }

    View reference_view(const std::string& scene) const {
        View view{.method = "reference", .budget = "", .caption = "reference", .image = {}};
        const Cell* a = find_cell(scene, Role::ReferenceA);
        const Cell* b = find_cell(scene, Role::ReferenceB);
        if (a == nullptr || b == nullptr) return view;
        view.caption += fmt::format(": {}, 2 × {}", a->task.method, to_string(a->budget));
        const std::string id_a = task_id(a->task);
        const std::string id_b = task_id(b->task);
        if (store_.has_run(id_a) && store_.has_run(id_b)) {
            view.image = mean_of(store_.run_image(id_a), store_.run_image(id_b));
        }
        return view;
    }

    // The first seed of the plan that is finished.
    View method_view(const std::string& scene, const std::string& method,
                     const Budget& budget) const {
        View view{.method = method,
                  .budget = to_string(budget),
                  .caption = method + ", " + to_string(budget),
                  .image = {}};
        for (const Cell& cell : plan_.cells) {
            const bool is_here = cell.role == Role::Test && cell.scene == scene &&
                                 cell.method == method && cell.budget == budget;
            if (!is_here) continue;
            const std::optional<Record> record = store_.run(task_id(cell.task));
            if (!record) continue;
            const RenderStatistics& run = record->statistics;
            view.caption += fmt::format(", seed {}: {} spp in {:.3g} s cpu, {:.3g} s wall",
                                        cell.seed, run.passes, run.cpu_seconds, run.wall_seconds);
            if (has_few_passes(budget, run.passes)) view.caption += ", FEW PASSES";
            if (!record->valid) view.caption += "; INVALID run";
            view.image = store_.run_image(record->run);
            break;
        }
        if (const ComparedCell* cell = comparison_.find(scene, method, budget)) {
            if (cell->mean) {
                view.caption +=
                    fmt::format("; {} {}", comparison_.metric, format_mean(*cell->mean));
            }
            if (cell->ratio) view.caption += ", " + format_ratio(*cell->ratio);
        }
        return view;
    }

    std::string scene_to_html(const PlannedScene& scene) const {
        const Cell* any = find_cell(scene.name, Role::Test);
        if (any == nullptr) return "";
        std::vector<std::string> names{"reference"};
        names.insert(names.end(), plan_.methods.begin(), plan_.methods.end());
        std::string html = fmt::format("<h3>{}</h3>\n", escape_html(scene.name));
        html += buttons("method", names, true);
        if (plan_.budgets.size() > 1) {
            std::vector<std::string> budgets;
            for (const Budget& budget : plan_.budgets) budgets.push_back(to_string(budget));
            html += buttons("budget", budgets, false);
        }
        std::vector<View> views{reference_view(scene.name)};
        for (const Budget& budget : plan_.budgets) {
            for (const std::string& method : plan_.methods) {
                views.push_back(method_view(scene.name, method, budget));
            }
        }
        for (View& view : views) {
            view.caption += fmt::format("; exposure {:+g} stops", scene.exposure);
            html += view_to_html(view, scene.exposure, any->task);
        }
        return html;
    }

    std::string scenes() const {
        std::string html;
        for (const PlannedScene& scene : plan_.scenes) html += scene_to_html(scene);
        return html;
    }

    std::string methods() const {
        const auto configuration = nlohmann::json::parse(plan_.configuration);
        std::string html =
            "<div class=\"scroll\"><table>\n<thead><tr><th>label</th><th>method</th>"
            "<th>parameters</th></tr></thead>\n<tbody>\n";
        const auto add_row = [&html](const std::string& label, const nlohmann::json& method) {
            std::string parameters;
            for (const auto& [name, value] : parameters_from_json(method.at("parameters"))) {
                parameters += fmt::format("<code>{}={}</code> ", escape_html(name),
                                          escape_html(to_string(value)));
            }
            html +=
                fmt::format("<tr><th>{}</th><td>{} v{}</td><td>{}</td></tr>\n", escape_html(label),
                            escape_html(method.at("method").get<std::string>()),
                            method.at("version").get<int>(), parameters);
        };
        for (const std::string& label : plan_.methods) {
            add_row(label, configuration.at("methods").at(label));
        }
        add_row("reference", configuration.at("reference"));
        return html + "</tbody></table></div>\n";
    }

    std::string provenance(const std::vector<std::string>& from) const {
        std::string html = "<ul>\n";
        for (const std::string& line : from) {
            html += "<li>" + escape_html(line) + "</li>\n";
        }
        for (const Cell& cell : plan_.cells) {
            const std::optional<TaskRow> row = store_.task(task_id(cell.task));
            if (!row || row->state != TaskState::Failed) continue;
            html += fmt::format("<li class=\"status\">failed: {}, {}, {}, seed {}: {}</li>\n",
                                escape_html(cell.scene), escape_html(cell.method),
                                to_string(cell.budget), cell.seed, escape_html(row->error));
        }
        return html + "</ul>\n";
    }

    const Store& store_;
    const Plan& plan_;
    Comparison comparison_;
};

}  // namespace

std::string make_report(const Store& store, const Plan& plan) {
    try {
        return Reporter(store, plan).report();
    } catch (const nlohmann::json::exception& e) {
        throw Error(Errc::DataLoss,
                    "read the configuration of experiment '" + plan.experiment + "': " + e.what());
    }
}

}  // namespace misbench
