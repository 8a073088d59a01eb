// Tables from comparison values: numbers, alignment, marks, and every format's escapes.
#include <gmock/gmock.h>

#include <cctype>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/report/numbers.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Estimate with_interval(double value, double low, double high) {
    return {.value = value, .interval = Interval{low, high}, .why_none = {}};
}

Estimate without_interval(double value, NoInterval why) {
    return {.value = value, .interval = {}, .why_none = why};
}

ComparedCell cell(const std::string& scene, const std::string& method, const Budget& budget,
                  Estimate mean, std::optional<Estimate> ratio = {}) {
    ComparedCell c;
    c.scene = scene;
    c.method = method;
    c.budget = budget;
    c.n_planned = c.n_measured = 5;
    c.values = {1, 2, 3, 4, 5};
    c.mean = mean;
    c.ratio = ratio;
    if (ratio && ratio->interval) c.p = c.adjusted_p = excludes_one(*ratio) ? 0.01 : 0.5;
    c.is_baseline = method == "pt";
    c.mean_passes = 16;
    c.mean_cpu_seconds = 0.5;
    c.mean_wall_seconds = 0.25;
    return c;
}

const Budget kFew = SampleBudget{16};
const Budget kLong = TimeBudget{2, BudgetClock::Wall};

Comparison two_by_two() {
    Comparison comparison;
    comparison.experiment = "exp";
    comparison.metric = "mse";
    comparison.formula = "mean of d²";
    comparison.baseline = "pt";
    comparison.scenes = {"Box", "Käfig"};
    comparison.methods = {"pt", "mis_2"};
    comparison.budgets = {kFew};
    comparison.cells = {
        cell("Box", "pt", kFew, with_interval(0.0123, 0.0112, 0.0134)),
        cell("Box", "mis_2", kFew, with_interval(0.0061, 0.0056, 0.0066),
             with_interval(0.5, 0.45, 0.56)),
        cell("Käfig", "pt", kFew, with_interval(1.5, 1.25, 1.75)),
        cell("Käfig", "mis_2", kFew, with_interval(1.6, 1.5, 1.7), with_interval(1.07, 0.9, 1.3))};
    return comparison;
}

TableLayout rows_and_columns(const std::string& rows, const std::string& columns) {
    TableLayout layout;
    layout.rows = rows;
    layout.columns = columns;
    return layout;
}

TableLayout layout_with(auto TableLayout::*part, const auto& value) {
    TableLayout layout;
    layout.*part = value;
    return layout;
}

Table table_of(const Comparison& comparison, const TableLayout& layout = {}) {
    return make_table(comparison, layout, {"machine: a CPU"});
}

// --- numbers -------------------------------------------------------------------------------------

TEST(Numbers, AMeanHasTheDigitsOfItsInterval) {
    EXPECT_EQ(format_mean(with_interval(0.0123456, 0.0112, 0.0134)), "0.0123 ± 0.0011");
    EXPECT_EQ(format_mean(with_interval(123.456, 120, 126.9)), "123.5 ± 3.5");
    EXPECT_EQ(format_mean(with_interval(12345.6, 10000, 14691.2)), "12346 ± 2346");
    EXPECT_EQ(format_mean(with_interval(1.234e-7, 1.1e-7, 1.368e-7)), "(1.23 ± 0.13)e-7");
    EXPECT_EQ(format_mean(with_interval(4.5e8, 4.4e8, 4.6e8)), "(4.50 ± 0.10)e8");
    EXPECT_EQ(format_mean(with_interval(-0.02, -0.05, 0.01)), "-0.020 ± 0.030");
    EXPECT_EQ(format_mean(with_interval(0, -0.01, 0.01)), "0.000 ± 0.010");
}

TEST(Numbers, AMeanWithoutIntervalHasThreeDigits) {
    EXPECT_EQ(format_mean(without_interval(0.0123456, NoInterval::TooFewValues)), "0.0123");
    EXPECT_EQ(format_mean(without_interval(1.23456e-8, NoInterval::NoSpread)), "1.23e-8");
}

TEST(Numbers, ARatioHasItsBounds) {
    EXPECT_EQ(format_ratio(with_interval(0.54321, 0.5, 0.58)), "×0.543 [0.500, 0.580]");
    EXPECT_EQ(format_ratio(with_interval(5.4, 0.042, 700)), "×5.400 [0.042, 700.000]");
    EXPECT_EQ(format_ratio(without_interval(0.5, NoInterval::TooFewValues)), "×0.500");
}

TEST(Numbers, ABoundBeyondOneIsNotRoundedToIt) {
    EXPECT_EQ(format_ratio(with_interval(1.02, 1.00004, 1.04)), "×1.02000 [1.00004, 1.04000]");
    EXPECT_EQ(format_ratio(with_interval(1.02, 0.9996, 1.04)), "×1.020 [1.000, 1.040]");
}

TEST(Numbers, DurationsReadLikeSpeech) {
    EXPECT_EQ(format_duration(0.4), "0 s");
    EXPECT_EQ(format_duration(59.4), "59 s");
    EXPECT_EQ(format_duration(200), "3 min 20 s");
    EXPECT_EQ(format_duration(7500), "2 h 5 min");
}

TEST(Numbers, WidthCountsColumnsNotBytes) {
    EXPECT_EQ(display_width("abc"), 3U);
    EXPECT_EQ(display_width("±×†‡–"), 5U);
    EXPECT_EQ(display_width("Käfig"), 5U);
    EXPECT_EQ(display_width("a\u0308"), 1U);  // a letter and a combining mark
    EXPECT_EQ(display_width("箱"), 2U);
    EXPECT_EQ(display_width("😀"), 2U);
    EXPECT_EQ(padded("ä", 3), "ä  ");
}

// --- layout --------------------------------------------------------------------------------------

TEST(Table, TextIsAlignedInEveryLine) {
    const std::string text = to_text(table_of(two_by_two()));
    EXPECT_THAT(text, testing::StartsWith("exp: mse, 16 spp\n\n"
                                          "scene   pt                mis_2\n"
                                          "\n"
                                          "Box     0.0123 ± 0.0011   0.00610 ± 0.00050\n"
                                          "        baseline          ×0.500 [0.450, 0.560] ▼*\n"
                                          "\n"
                                          "Käfig   1.50 ± 0.25       1.60 ± 0.10\n"
                                          "        baseline          ×1.07 [0.90, 1.30]\n"
                                          "\n"
                                          "metric: mse, mean of d²; less is better\n"));
    EXPECT_THAT(text,
                AllOf(HasSubstr("mean over 5 seeds ± half of its 95 % Student t interval\n"),
                      HasSubstr("to baseline 'pt' [95 % log-delta-t interval, Welch]\n"),
                      HasSubstr("machine: a CPU\n"), Not(HasSubstr("†")), Not(HasSubstr("‡"))));
}

TEST(Table, SaysWhatASeedRuleHasReachedAndWhoseSeedsARatioIsOf) {
    Comparison comparison = two_by_two();
    comparison.seed_rule = {{.min = 3, .max = 5, .ratio_halfwidth = 0.1}, "mse", "pt", true};
    for (ComparedCell& cell : comparison.cells) {
        cell.n_planned = cell.n_measured = cell.method == "pt" ? 5 : 3;
        cell.ratio_is_paired = true;
    }
    const std::string text = to_text(table_of(comparison));
    EXPECT_THAT(text, AllOf(HasSubstr("mean over 3 to 5 seeds"),
                            HasSubstr("seeds: 3 to 5, until the ratio is known within ± 10 %: met "
                                      "by 0 of 2 ratios; 2 wide with fewer seeds\n"),
                            HasSubstr("paired by seed], of the seeds that both have\n")));
}

TEST(Table, RowsAndColumnsAreChosenAndTheThirdAxisMakesFurtherRows) {
    Comparison comparison = two_by_two();
    comparison.budgets.push_back(kLong);
    comparison.cells.push_back(cell("Box", "pt", kLong, with_interval(7, 6, 8)));
    const Table table = table_of(comparison, rows_and_columns("method", "scene"));
    EXPECT_EQ(table.title, "exp: mse");
    EXPECT_THAT(table.label_headers, ElementsAre("method", "budget"));
    EXPECT_THAT(table.columns, ElementsAre("Box", "Käfig"));
    ASSERT_EQ(table.rows.size(), 3U);  // none for mis_2 in 2 s, which has no cell
    EXPECT_THAT(table.rows[0].labels, ElementsAre("pt", "16 spp"));
    EXPECT_THAT(table.rows[1].labels, ElementsAre("pt", "2 s wall"));
    EXPECT_EQ(table.rows[1].cells[0].mean, "7.0 ± 1.0");
    EXPECT_EQ(table.rows[1].cells[0].effort, "about 16 spp in 0.25 s wall");
    EXPECT_EQ(table.rows[1].cells[1].mean, "–");
    EXPECT_THAT(table.rows[2].labels, ElementsAre("mis_2", "16 spp"));
    EXPECT_EQ(table.rows[2].cells[1].mean, "1.60 ± 0.10");
}

TEST(Table, TheSameAxisTwiceIsRefused) {
    EXPECT_THROW(table_of(two_by_two(), rows_and_columns("scene", "scene")), Error);
    try {
        table_of(two_by_two(), rows_and_columns("seed", "method"));
        ADD_FAILURE() << "laid out";
    } catch (const Error& e) {
        EXPECT_STREQ(e.what(), "unknown axis 'seed'; known: scene method budget metric experiment");
    }
}

TEST(Table, AVerdictNeedsAnIntervalThatExcludesOneAndAMetricThatRanks) {
    Comparison comparison = two_by_two();
    EXPECT_EQ(table_of(comparison).rows[0].cells[1].verdict, Verdict::Better);
    EXPECT_EQ(table_of(comparison).rows[1].cells[1].verdict, Verdict::None);
    comparison.cells[1].ratio = with_interval(2, 1.5, 2.5);
    EXPECT_EQ(table_of(comparison).rows[0].cells[1].verdict, Verdict::Worse);
    comparison.better = Direction::None;
    EXPECT_EQ(table_of(comparison).rows[0].cells[1].verdict, Verdict::Different);
    EXPECT_THAT(table_of(comparison).footer[0], Not(HasSubstr("less is better")));
}

TEST(Table, TheFooterSaysHowRatiosAreTaken) {
    Comparison comparison = two_by_two();
    comparison.cells[1].ratio_is_paired = true;
    EXPECT_THAT(table_of(comparison).footer[2],
                HasSubstr("log-delta-t interval, paired by seed, or Welch where seeds differ]"));
    comparison.cells[3].ratio_is_paired = true;
    EXPECT_THAT(table_of(comparison).footer[2], HasSubstr("log-delta-t interval, paired by seed]"));
}

TEST(Table, ARatioThatCannotBeFormedIsShownAsMissing) {
    Comparison comparison = two_by_two();
    comparison.cells[1].ratio.reset();
    EXPECT_EQ(table_of(comparison).rows[0].cells[1].ratio, "–");
    EXPECT_EQ(table_of(comparison).rows[0].cells[0].ratio, "baseline");
}

TEST(Table, UnfinishedFailedAndInvalidSeedsAreSaid) {
    Comparison comparison = two_by_two();
    ComparedCell& part = comparison.cells[0];
    part.n_measured = 2;
    part.n_invalid = part.n_failed = part.n_unfinished = 1;
    ComparedCell& none = comparison.cells[1];
    none.n_measured = 0;
    none.n_unreferenced = 5;
    none.mean.reset();
    none.ratio.reset();
    const Table table = table_of(comparison);
    EXPECT_EQ(table.rows[0].cells[0].status, "2 of 5 seeds: 1 invalid, 1 failed, 1 unfinished");
    EXPECT_EQ(table.rows[0].cells[1].status, "0 of 5 seeds: 5 without reference");
    EXPECT_EQ(table.rows[0].cells[1].mean, "");
    EXPECT_EQ(table.rows[0].cells[1].ratio, "");
    EXPECT_EQ(table.rows[1].cells[0].status, "");
    EXPECT_THAT(to_text(table), HasSubstr("2 of 5 seeds: 1 invalid, 1 failed, 1 unfinished"));
}

TEST(Table, DoubtfulNumbersAreMarkedAndTheMarksExplained) {
    Comparison comparison = two_by_two();
    comparison.cells[0].few_passes = true;
    comparison.cells[1].tail_verdict = TailVerdict::Heavy;
    comparison.cells[3].mean = without_interval(1.6, NoInterval::TooFewValues);
    comparison.cells[3].ratio = without_interval(1.07, NoInterval::TooFewValues);
    const Table table = table_of(comparison);
    EXPECT_EQ(table.rows[0].cells[0].mean, "0.0123 ± 0.0011 †");
    EXPECT_EQ(table.rows[0].cells[1].mean, "0.00610 ± 0.00050 ‡");
    EXPECT_EQ(table.rows[1].cells[1].mean, "1.60 a");
    EXPECT_EQ(table.rows[1].cells[1].ratio, "×1.07 a");
    EXPECT_THAT(to_text(table), AllOf(HasSubstr("\n† a run has fewer than 10 passes"),
                                      HasSubstr("\n‡ the largest seed is more than 3 × the"),
                                      HasSubstr("\na no interval: fewer than 3 seeds\n")));
}

TEST(Table, WhereRareSeedsCarryTheErrorAWarningStandsForTheInterval) {
    Comparison comparison = two_by_two();
    for (const std::size_t i : {1U, 2U}) {
        comparison.cells[i].tail_verdict = TailVerdict::Dishonest;
        comparison.cells[i].tail = 40;
        comparison.cells[i].mean = without_interval(0.0061, NoInterval::HeavyTail);
    }
    comparison.cells[1].ratio = without_interval(0.5, NoInterval::HeavyTail);
    comparison.cells[1].p = comparison.cells[1].adjusted_p = std::nullopt;
    comparison.cells[3].ratio = without_interval(1.07, NoInterval::HeavyTail);
    comparison.cells[3].mean = without_interval(1.6, NoInterval::TooFewValues);
    const Table table = table_of(comparison);
    EXPECT_EQ(table.rows[0].cells[1].mean, "0.00610 a");
    EXPECT_EQ(table.rows[0].cells[1].ratio, "×0.500 a");
    EXPECT_EQ(table.rows[0].cells[1].verdict, Verdict::None);
    EXPECT_EQ(table.rows[1].cells[0].mean, "0.00610 a");
    EXPECT_EQ(table.rows[1].cells[1].ratio, "×1.07 a") << "of a baseline with such a tail";
    for (const std::string& text : {to_text(table), to_markdown(table), to_latex(table)}) {
        EXPECT_THAT(text, AllOf(HasSubstr("a no interval: rare seeds carry a mean, and fewer"),
                                Not(HasSubstr("‡")), Not(HasSubstr("ddag"))));
    }
    EXPECT_THAT(to_html(table), HasSubstr("<li>a no interval: rare seeds carry a mean"));
    EXPECT_LT(to_text(table).find("\na no interval"), to_text(table).find("\nb no interval: few"));
    const auto json = nlohmann::json::parse(to_json({&comparison, 1}));
    const auto& cell = json.at("cells").at(1);
    EXPECT_EQ(cell.at("tail_verdict"), "dishonest");
    EXPECT_EQ(cell.at("ratio").at("no_interval"), to_string(NoInterval::HeavyTail));
    EXPECT_EQ(cell.at("mean").at("no_interval"), to_string(NoInterval::HeavyTail));
    EXPECT_FALSE(cell.at("ratio").contains("interval"));
    EXPECT_THAT(to_csv({&comparison, 1}), HasSubstr(",0.0061,,,0.5,,,false,false,,,false,false,"
                                                    "40.0,dishonest,"));
    const std::string macros = to_latex_macros({&comparison, 1}, {});
    EXPECT_THAT(macros, AllOf(HasSubstr("MisTwoOneSixSppRatio}"),
                              Not(HasSubstr("BoxMisTwoOneSixSppRatioLow"))));
}

TEST(Table, ErrorsThatTheReferenceSpoilsAreMarkedInEveryFormat) {
    Comparison comparison = two_by_two();
    comparison.cells[1].reference_share = 0.06;
    comparison.cells[2].reference_share = 0.05;
    const Table table = table_of(comparison);
    EXPECT_EQ(table.rows[0].cells[1].mean, "0.00610 ± 0.00050 §");
    EXPECT_EQ(table.rows[1].cells[0].mean, "1.50 ± 0.25");
    const std::string footnote =
        "§ more than 5 % of the error is the reference's own noise: `misbench reference STORE "
        "--improve 4`";
    EXPECT_THAT(to_text(table), HasSubstr(footnote));
    EXPECT_THAT(to_markdown(table), AllOf(HasSubstr("0.00610 ± 0.00050 §"), HasSubstr(footnote)));
    EXPECT_THAT(to_latex(table),
                AllOf(HasSubstr("0.00610 $\\pm$ 0.00050 \\S{}"), HasSubstr("% " + footnote)));
    EXPECT_THAT(to_html(table), AllOf(HasSubstr("0.00610 ± 0.00050 §"), HasSubstr("<li>§ more")));
    const auto json = nlohmann::json::parse(to_json({&comparison, 1}));
    EXPECT_EQ(json.at("cells").at(0).at("reference_share"), nullptr);
    EXPECT_EQ(json.at("cells").at(1).at("reference_share"), 0.06);
    EXPECT_EQ(json.at("cells").at(1).at("noisy_reference"), true);
    EXPECT_EQ(json.at("cells").at(2).at("noisy_reference"), false);
    EXPECT_THAT(to_csv({&comparison, 1}), HasSubstr(",calm,0.06,16.0,"));
    comparison.cells[1].reference_share.reset();
    EXPECT_THAT(to_text(table_of(comparison)), Not(HasSubstr("§")));
}

TEST(Table, ATailHasNeitherMeansNorRatios) {
    Comparison comparison = two_by_two();
    comparison.metric = "tail(mse)";
    comparison.baseline = kToNone;
    for (ComparedCell& c : comparison.cells) {
        c.mean = without_interval(1.25, NoInterval::NoEstimate);
        c.ratio.reset();
        c.adjusted_p.reset();
    }
    comparison.cells[3].mean.reset();  // of a median that is not above zero
    const Table table = table_of(comparison);
    EXPECT_EQ(table.rows[0].cells[0].mean, "1.25 a");
    EXPECT_EQ(table.rows[0].cells[0].ratio, "");
    EXPECT_EQ(table.rows[1].cells[1].mean, "–");
    EXPECT_THAT(to_text(table), AllOf(HasSubstr("a no interval: it describes these seeds"),
                                      Not(HasSubstr("mean over")), Not(HasSubstr("ratio"))));
}

TEST(Table, AnyAxesAreShownAndRowsSayWhatTellsCellsApart) {
    std::vector<Comparison> both{two_by_two(), two_by_two()};
    both[1].metric = "relmse";
    for (Comparison& comparison : both) {
        for (ComparedCell& c : comparison.cells) {
            if (c.method == "mis_2") c.parameters = {{"depth", std::int64_t{12}}};
            if (c.method == "pt") c.parameters = {{"depth", std::int64_t{5}}};
        }
    }
    const Table by_metric = make_table(both, rows_and_columns("method", "metric"), {});
    EXPECT_THAT(by_metric.columns, ElementsAre("mse", "relmse"));
    EXPECT_THAT(by_metric.label_headers, ElementsAre("method", "scene"));
    ASSERT_EQ(by_metric.rows.size(), 4U);
    EXPECT_THAT(by_metric.rows[1].labels, ElementsAre("pt", "Käfig"));
    const Table by_depth = make_table(both, rows_and_columns("scene", "depth"), {});
    EXPECT_THAT(by_depth.columns, ElementsAre("5", "12"));
    EXPECT_THAT(by_depth.label_headers, ElementsAre("scene", "metric"));
}

TEST(Table, RowsAreSortedWithMeansOfScenesLast) {
    Comparison comparison = two_by_two();
    ComparedCell mean;
    mean.scene = "all";
    mean.method = "mis_2";
    mean.budget = kFew;
    mean.ratio = with_interval(0.7, 0.5, 0.9);
    mean.is_mean_of_scenes = true;
    comparison.scenes.emplace_back("all");
    comparison.cells.push_back(mean);
    const auto order = [&](const std::string& sort) {
        std::vector<std::string> labels;
        for (const TableRow& row :
             table_of(comparison, layout_with(&TableLayout::sort, sort)).rows) {
            labels.push_back(row.labels[0]);
        }
        return labels;
    };
    comparison.cells[0].mean->value = 3;
    EXPECT_THAT(order(""), ElementsAre("Box", "Käfig", "all"));
    EXPECT_THAT(order("pt"), ElementsAre("Käfig", "Box", "all"));
    EXPECT_THAT(order("mis_2"), ElementsAre("Box", "Käfig", "all"));
    EXPECT_THAT(order("name"), ElementsAre("Box", "Käfig", "all"));
    EXPECT_THROW(order("pt2"), Error);
    EXPECT_THAT(to_text(table_of(comparison)),
                HasSubstr("\ngeometric means of ratios: of these scenes [from the spread of the "
                          "seeds], of scenes like these [bootstrap-t over scenes, of 5 or more; no "
                          "test]\n"));
    EXPECT_EQ(table_of(comparison).rows[2].cells[1].ratio, "×0.70 [0.50, 0.90]");
}

TEST(Table, PartsAreHiddenAndDigitsChosen) {
    TableLayout layout;
    layout.hidden = {"mean", "seeds", "effort", "footer"};
    layout.digits = 2;
    const Table table = table_of(two_by_two(), layout);
    EXPECT_EQ(table.rows[0].cells[1].mean, "");
    EXPECT_EQ(table.rows[0].cells[1].ratio, "×0.50 [0.45, 0.56] ▼*");
    EXPECT_EQ(table.rows[0].cells[1].effort, "");
    EXPECT_TRUE(table.footer.empty());
    EXPECT_EQ(
        table_of(two_by_two(), layout_with(&TableLayout::hidden, std::set<std::string>{"ratio"}))
            .rows[0]
            .cells[1]
            .ratio,
        "");
    EXPECT_EQ(table_of(two_by_two(), layout_with(&TableLayout::digits, 2)).rows[0].cells[0].mean,
              "0.012 ± 0.001");
}

TEST(Table, ADifferenceThatDoesNotSurviveIsNotMarked) {
    Comparison comparison = two_by_two();
    comparison.cells[1].adjusted_p = 0.06;  // though its interval excludes 1
    const Table table = table_of(comparison);
    EXPECT_EQ(table.rows[0].cells[1].ratio, "×0.500 [0.450, 0.560]");
    EXPECT_EQ(table.rows[0].cells[1].verdict, Verdict::None);
    EXPECT_THAT(to_text(table), HasSubstr("p ≤ 0.05, adjusted for all 2 ratios of the table"));
}

// --- formats -------------------------------------------------------------------------------------

TEST(TableFormats, EscapesKeepNamesFromBeingSyntax) {
    EXPECT_EQ(escape_html("<a href=\"x\">'&'</a>"),
              "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
    EXPECT_EQ(escape_latex("50 % of a_1 & $b^2 ~ {c} \\d #1"),
              "50 \\% of a\\_1 \\& \\$b\\textasciicircum{}2 \\textasciitilde{} \\{c\\} "
              "\\textbackslash{}d \\#1");
    EXPECT_EQ(escape_latex("×0.5 ± 1 †"), "$\\times$0.5 $\\pm$ 1 \\dag{}");
    EXPECT_EQ(escape_csv("plain"), "plain");
    EXPECT_EQ(escape_csv("a,\"b\"\nc"), "\"a,\"\"b\"\"\nc\"");
}

TEST(TableFormats, MarkdownHasOneLinePerRow) {
    Comparison comparison = two_by_two();
    comparison.methods[1] = "a|b";
    comparison.cells[1].method = comparison.cells[3].method = "a|b";
    const std::string markdown = to_markdown(table_of(comparison));
    EXPECT_THAT(markdown, HasSubstr("| scene | pt | a\\|b |\n|---|---:|---:|\n"
                                    "| Box | 0.0123 ± 0.0011<br>baseline | 0.00610 ± 0.00050<br>"
                                    "**×0.500 [0.450, 0.560] ▼\\*** |\n"));
}

TEST(TableFormats, LatexIsATabularWithTheFooterAsComments) {
    const std::string latex = to_latex(table_of(two_by_two()));
    EXPECT_THAT(
        latex,
        AllOf(HasSubstr("\\begin{tabular}{lrr}\n\\toprule\nscene & pt & mis\\_2 \\\\\n"),
              HasSubstr("Box & \\shortstack[r]{0.0123 $\\pm$ 0.0011\\\\baseline} & "),
              HasSubstr("\\textbf{$\\times$0.500 {[}0.450, 0.560{]} $\\downarrow$*}} \\\\\n"),
              HasSubstr("\n% machine: a CPU\n"), HasSubstr("\\end{tabular}\n")));
}

TEST(TableFormats, HtmlMarksVerdictsAndEscapesNames) {
    Comparison comparison = two_by_two();
    comparison.scenes[0] = comparison.cells[0].scene = comparison.cells[1].scene = "<Box>";
    const std::string html = to_html(table_of(comparison));
    EXPECT_THAT(html, AllOf(HasSubstr("<th>&lt;Box&gt;</th>"), Not(HasSubstr("<Box>")),
                            HasSubstr("<td class=\"better\"><span class=\"mean\">0.00610"),
                            HasSubstr("about 16 spp in 0.5 s cpu")));
}

TEST(TableFormats, LatexMacrosHaveTheDigitsOfTheTableAndNamesOfLetters) {
    Comparison comparison = two_by_two();
    comparison.scenes[1] = comparison.cells[2].scene = comparison.cells[3].scene = "B-ox 2.5";
    comparison.cells[0].mean = with_interval(1.234e-7, 1.1e-7, 1.368e-7);
    const std::string tex = to_latex_macros({&comparison, 1}, {});
    EXPECT_THAT(
        tex, testing::StartsWith(
                 "\\newcommand{\\ExpMseBoxPtOneSixSppMean}{\\ensuremath{1.23\\times 10^{-7}}}\n"));
    EXPECT_THAT(tex, AllOf(HasSubstr("\\newcommand{\\ExpMseBoxMisTwoOneSixSppMean}{0.00610}\n"),
                           HasSubstr("\\ExpMseBoxMisTwoOneSixSppMeanLow}{0.00560}\n"),
                           HasSubstr("\\ExpMseBoxMisTwoOneSixSppRatioHigh}{0.560}\n"),
                           HasSubstr("\\ExpMseBOxTwoPointFivePtOneSixSppMean}{1.50}\n")));
}

TEST(TableFormats, LatexMacrosOfDifferentNumbersHaveDifferentNames) {
    Comparison comparison = two_by_two();
    for (const std::size_t i : {0U, 1U}) comparison.cells[i].scene = "a b";
    for (const std::size_t i : {2U, 3U}) comparison.cells[i].scene = "a-b";
    comparison.cells[3].method = "Mean Low";
    const std::string tex = to_latex_macros({&comparison, 1}, {});
    std::set<std::string> names;
    int n_lines = 0;
    for (std::size_t at = 0; at < tex.size(); at = tex.find('\n', at) + 1) {
        const std::size_t begin = at + std::string("\\newcommand{\\").size();
        const std::string name = tex.substr(begin, tex.find('}', begin) - begin);
        EXPECT_TRUE(std::ranges::all_of(name, [](unsigned char c) { return std::isalpha(c); }));
        names.insert(name);
        ++n_lines;
    }
    EXPECT_EQ(names.size(), 18U);
    EXPECT_EQ(n_lines, 18);
}

TEST(TableFormats, CsvHasEveryCellInFullPrecision) {
    Comparison comparison = two_by_two();
    comparison.cells[0].mean->value = 1.0 / 3;
    const std::string csv = to_csv({&comparison, 1});
    std::vector<std::size_t> commas;
    for (std::size_t at = 0; at < csv.size();) {
        const std::size_t end = csv.find('\n', at);
        commas.push_back(static_cast<std::size_t>(
            std::count(csv.begin() + static_cast<std::ptrdiff_t>(at),
                       csv.begin() + static_cast<std::ptrdiff_t>(end), ',')));
        at = end + 1;
    }
    EXPECT_EQ(commas, std::vector<std::size_t>(5, 28));
    EXPECT_THAT(csv, AllOf(HasSubstr("\nexp,mse,Box,pt,16 spp,5,5,0,0,0,0,0.3333333333333333,"
                                     "0.0112,0.0134,,,,false,false,,,true,false,,calm,,16.0,0.25,"
                                     "0.5\n"),
                           HasSubstr(",0.5,0.45,0.56,false,true,0.01,0.01,false,")));
}

TEST(TableFormats, JsonHasValuesIntervalsAndReasons) {
    Comparison comparison = two_by_two();
    comparison.cells[3].ratio = without_interval(1.07, NoInterval::Unbounded);
    const auto json = nlohmann::json::parse(to_json({&comparison, 1}));
    EXPECT_EQ(json.at("baseline"), "pt");
    EXPECT_EQ(json.at("confidence"), 0.95);
    const auto& cells = json.at("cells");
    EXPECT_EQ(cells.at(1).at("ratio").at("interval"), (nlohmann::json{0.45, 0.56}));
    EXPECT_EQ(cells.at(1).at("ratio_excludes_one"), true);
    EXPECT_EQ(cells.at(0).at("ratio"), nullptr);
    EXPECT_EQ(cells.at(0).at("values"), (nlohmann::json{1, 2, 3, 4, 5}));
    EXPECT_EQ(cells.at(3).at("ratio").at("no_interval"), to_string(NoInterval::Unbounded));
}

}  // namespace
}  // namespace misbench
