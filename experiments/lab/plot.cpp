#include "experiments/lab/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace misbench::lab {
namespace {

// All in pixels.
constexpr double kPanelWidth = 190;
constexpr double kPanelHeight = 130;
constexpr double kGapX = 44;
constexpr double kGapY = 76;
constexpr double kMarginX = 40;
constexpr double kMarginTop = 74;
constexpr double kBarsWidth = 290;
constexpr double kBarsLabels = 90;  // of kBarsWidth, for the names
constexpr int kPoints = 600;        // of a curve

// Okabe and Ito's colours, which most people can tell apart.
constexpr std::array<std::string_view, 6> kColours{"#0072B2", "#E69F00", "#009E73",
                                                   "#CC79A7", "#56B4E9", "#D55E00"};

std::string_view colour(std::size_t technique) { return kColours[technique % kColours.size()]; }

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '&') {
            result += "&amp;";
        } else if (c == '<') {
            result += "&lt;";
        } else if (c == '>') {
            result += "&gt;";
        } else {
            result += c;
        }
    }
    return result;
}

std::string text_at(double x, double y, std::string_view text, std::string_view attributes = "") {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}{}>{}</text>\n", x, y,
                       attributes.empty() ? "" : " ", attributes, escaped(text));
}

// A frame with axes: what is inside is cut off at its border.
class Panel {
 public:
    Panel(double left, double top, Domain x, Domain y) : left_(left), top_(top), x_(x), y_(y) {}

    std::string frame(std::string_view title) const {
        std::string svg = fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" class=\"frame\"/>\n", left_,
            top_, kPanelWidth, kPanelHeight);
        svg += text_at(left_ + kPanelWidth / 2, top_ - 7, title, "class=\"title\"");
        for (const double y : {y_.low, y_.high}) {
            svg += text_at(left_ - 4, screen_y(y) + 4, fmt::format("{:.3g}", y),
                           "class=\"tick\" text-anchor=\"end\"");
        }
        for (const double x : {x_.low, x_.high}) {
            svg += text_at(screen_x(x), top_ + kPanelHeight + 13, fmt::format("{:.3g}", x),
                           "class=\"tick\" text-anchor=\"middle\"");
        }
        for (const double y : {0.0, 1.0}) {
            if (y <= y_.low || y >= y_.high) continue;
            svg += fmt::format(
                "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" "
                "class=\"level\"/>\n",
                left_, left_ + kPanelWidth, screen_y(y), screen_y(y));
            svg += text_at(left_ - 4, screen_y(y) + 4, fmt::format("{:g}", y),
                           "class=\"tick\" text-anchor=\"end\"");
        }
        return svg;
    }

    // `value` of a point may be NaN, where the line is interrupted.
    template <typename Function>
    std::string curve(const Function& value, std::string_view style) const {
        std::string path;
        bool is_drawing = false;
        for (int i = 0; i < kPoints; ++i) {
            const double x = std::lerp(x_.low, x_.high, (i + 0.5) / kPoints);
            const double y = value(x);
            if (!std::isfinite(y)) {
                is_drawing = false;
                continue;
            }
            path += fmt::format("{}{:.1f},{:.1f}", is_drawing ? " " : " M", screen_x(x),
                                screen_y(std::clamp(y, y_.low, y_.high)));
            is_drawing = true;
        }
        return fmt::format("<path d=\"{}\" fill=\"none\" {}/>\n", path, style);
    }

 private:
    double screen_x(double x) const {
        return left_ + kPanelWidth * (x - x_.low) / (x_.high - x_.low);
    }
    double screen_y(double y) const {
        return top_ + kPanelHeight * (y_.high - y) / (y_.high - y_.low);
    }

    double left_;
    double top_;
    Domain x_;
    Domain y_;
};

std::string line_style(std::size_t technique) {
    return fmt::format("stroke=\"{}\" stroke-width=\"1.8\"", colour(technique));
}

template <typename Function>
Domain range_of(const Domain& domain, const Function& value, Domain range) {
    for (int i = 0; i < kPoints; ++i) {
        const double y = value(std::lerp(domain.low, domain.high, (i + 0.5) / kPoints));
        if (!std::isfinite(y)) continue;
        range.low = std::min(range.low, y);
        range.high = std::max(range.high, y);
    }
    return range;
}

// The integrand is black and dashed, each density in its technique's colour.
std::string problem_panel(const Problem& problem, double left, double top) {
    const auto integrand = [&](double x) { return problem.integrand.value(x); };
    Domain range = range_of(problem.domain, integrand, {0, 0});
    for (const Technique& technique : problem.techniques) {
        range = range_of(
            problem.domain, [&](double x) { return technique.density.value(x); }, range);
    }
    const Panel panel(left, top, problem.domain, range);
    std::string svg = panel.frame("integrand and densities");
    for (std::size_t t = 0; t < problem.techniques.size(); ++t) {
        const Technique& technique = problem.techniques[t];
        svg += panel.curve([&](double x) { return technique.density.value(x); }, line_style(t));
    }
    svg += panel.curve(integrand, "stroke=\"black\" stroke-width=\"2\" stroke-dasharray=\"5 3\"");
    return svg;
}

std::string weights_panel(const Problem& problem, const FixedWeights& weights,
                          std::string_view title, double left, double top) {
    // Optimal weights have poles where the integrand is 0.
    constexpr Domain kWidest{-2, 3};
    Domain range{0, 1};
    const auto weight = [&](std::size_t t) {
        return [&, t](double x) {
            const auto all = weights_at(problem, weights, x);
            return all ? (*all)[t] : std::nan("");
        };
    };
    for (std::size_t t = 0; t < problem.techniques.size(); ++t) {
        range = range_of(problem.domain, weight(t), range);
    }
    range = {std::max(range.low, kWidest.low), std::min(range.high, kWidest.high)};
    // Weights that are only negative by rounding are 0.
    if (range.low > -1e-6) range.low = 0;
    if (range.high < 1 + 1e-6) range.high = 1;
    const Panel panel(left, top, problem.domain, range);
    std::string svg = panel.frame(title);
    for (std::size_t t = 0; t < problem.techniques.size(); ++t) {
        svg += panel.curve(weight(t), line_style(t));
    }
    return svg;
}

// Ratios to the balance heuristic; bars that do not fit are cut off and say their number.
std::string bars(const Case& of, const CaseOutcome& outcome, double left, double top) {
    constexpr double kMostRatio = 2;
    const double scale = (kBarsWidth - kBarsLabels - 50) / kMostRatio;
    const double step = std::min(16.0, kPanelHeight / static_cast<double>(of.weightings.size()));
    const double zero = left + kBarsLabels;
    std::string svg = text_at(zero + scale, top - 7, "error / error of balance", "class=\"title\"");
    for (std::size_t i = 0; i < of.weightings.size(); ++i) {
        const double y = top + step * static_cast<double>(i);
        svg += text_at(zero - 5, y + 0.75 * step, of.weightings[i].name,
                       "class=\"label\" text-anchor=\"end\"");
        const std::optional<double>& ratio = outcome.outcomes[i].error_ratio;
        if (!ratio || std::isnan(*ratio)) continue;
        const double length = scale * std::clamp(*ratio, 0.0, kMostRatio);
        svg += fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
            "fill=\"{}\"/>\n",
            zero, y + 1, length, step - 3, *ratio > 1 ? "#999" : "#555");
        svg += text_at(zero + length + 4, y + 0.75 * step, fmt::format("{:.3g}", *ratio),
                       "class=\"label\"");
    }
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" class=\"level\"/>\n",
        zero + scale, top, top + step * static_cast<double>(of.weightings.size()));
    return svg;
}

std::string_view layout_name(const Technique& technique) {
    if (technique.layout == Layout::Stratified) return " stratified";
    return technique.layout == Layout::Shared ? " shared" : "";
}

// The row's heading, with the techniques in their colours.
std::string heading(const Problem& problem, double top) {
    std::string svg = fmt::format("<text x=\"{}\" y=\"{:.1f}\" class=\"heading\">{}", kMarginX,
                                  top - 30, escaped(problem.name));
    for (std::size_t t = 0; t < problem.techniques.size(); ++t) {
        const Technique& technique = problem.techniques[t];
        svg += fmt::format("<tspan dx=\"14\" fill=\"{}\">{} ({}{})</tspan>", colour(t),
                           escaped(technique.name), technique.samples, layout_name(technique));
    }
    return svg + "</text>\n";
}

// Weights that say nothing when drawn are those of one technique and those of no one x.
bool has_panel(const Weighting& weighting, const Outcome& outcome) {
    return outcome.weights && !std::holds_alternative<OneTechnique>(weighting.kind);
}

std::string row(const Case& of, const CaseOutcome& outcome, double top, double& right) {
    std::string svg = heading(of.problem, top);
    double left = kMarginX;
    svg += problem_panel(of.problem, left, top);
    for (std::size_t i = 0; i < of.weightings.size(); ++i) {
        if (!has_panel(of.weightings[i], outcome.outcomes[i])) continue;
        left += kPanelWidth + kGapX;
        svg += weights_panel(of.problem, *outcome.outcomes[i].weights, of.weightings[i].name, left,
                             top);
    }
    left += kPanelWidth + 10;
    svg += bars(of, outcome, left, top);
    right = std::max(right, left + kBarsWidth);
    return svg;
}

}  // namespace

std::string to_svg(const Study& study, const std::vector<CaseOutcome>& outcomes) {
    std::string rows;
    double right = 0;
    double top = kMarginTop + 20;
    for (std::size_t i = 0; i < study.cases.size(); ++i) {
        rows += row(study.cases[i], outcomes[i], top, right);
        top += kPanelHeight + kGapY;
    }
    const double height = top - kGapY + 30;
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
               "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\">\n"
               "<style>.frame{{fill:none;stroke:#888}} .level{{stroke:#ccc}} "
               ".title{{font-size:12px;text-anchor:middle}} .tick{{font-size:9px;fill:#555}} "
               ".label{{font-size:10px}} .heading{{font-size:13px;font-weight:bold}} "
               ".name{{font-size:16px}}</style>\n"
               "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
               right + 10, height) +
           text_at(kMarginX, 28, study.name + ": integrand dashed, weights by technique",
                   "class=\"name\"") +
           rows + "</svg>\n";
}

}  // namespace misbench::lab
