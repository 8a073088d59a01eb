// Claims and findings as text, for people and for programs.
#include "experiments/report/claims_formats.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace misbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

ClaimFinding decided() {
    ClaimFinding found;
    found.claim = {.text = "less | noise",
                   .where = "Fig. 8",
                   .scenes = {"Box", "Käfig"},
                   .method = "ours",
                   .against = "mis_2",
                   .metric = "mse",
                   .budget = SampleBudget{16},
                   .expect = Expectation::Less,
                   .paper = {{"Box", 0.63}},
                   .note = "a <note>"};
    found.scene = "Box";
    found.ratio = Estimate{.value = 0.6, .interval = Interval{0.55, 0.65}, .why_none = {}};
    found.paper = 0.63;
    found.n_seeds = 10;
    found.is_paired = true;
    found.finding = Finding::Reproduced;
    return found;
}

ClaimFinding undecided() {
    ClaimFinding found = decided();
    found.scene = "Käfig";
    found.ratio = Estimate{.value = 0.95, .interval = Interval{0.8, 1.1}, .why_none = {}};
    found.paper.reset();
    found.finding = Finding::NotDecided;
    found.more_seeds = 14;
    found.has_heavy_tail = true;
    return found;
}

ClaimFinding missing() {
    ClaimFinding found = decided();
    found.claim.text = "never worse";
    found.claim.over = ClaimOver::Worst;
    found.claim.expect = Expectation::NotMore;
    found.claim.note = found.claim.where = "";
    found.scene = "";
    found.ratio.reset();
    found.paper.reset();
    found.n_seeds = 1;
    found.is_paired = false;
    found.finding = Finding::NotMeasured;
    found.reason = "Box, ours: 1 of 10 seeds: 9 unfinished";
    return found;
}

std::vector<ExperimentFindings> all() { return {{"exp", {decided(), undecided(), missing()}}}; }

TEST(ClaimsFormats, TextIsALineForEachFindingBelowItsClaim) {
    EXPECT_EQ(claims_to_text(all()),
              "claims of exp: 1 reproduced, 1 not decided, 1 not measured\n"
              "\n"
              "less | noise (Fig. 8)\n"
              "  ours/mis_2, mse at 16 spp, said to be less than 1\n"
              "  reproduced   Box    ×0.600 [0.550, 0.650]  paper ×0.63, within ours  10 seeds\n"
              "  not decided  Käfig  ×0.95 [0.80, 1.10] ‡                             10 seeds; "
              "about 14 more seeds may decide\n"
              "  note: a <note>\n"
              "\n"
              "never worse\n"
              "  ours/mis_2, mse at 16 spp, said to be at most 1.05\n"
              "  not measured  worst of 2 scenes  –  1 seed; Box, ours: 1 of 10 seeds: 9 "
              "unfinished\n"
              "\n"
              "× ratio of means [95 % log-delta-t interval, paired by seed, or Welch where seeds "
              "differ]; each finding is wrong for at "
              "most 5 % of experiments\n"
              "‡ the largest seed is more than 3 × the median one: rare samples carry the error, "
              "intervals may be too short\n");
}

TEST(ClaimsFormats, EveryExperimentHasItsOwnText) {
    const std::string text = claims_to_text({{"one", {decided()}}, {"two", {missing()}}});
    EXPECT_THAT(text, AllOf(StartsWith("claims of one: 1 reproduced\n"),
                            HasSubstr("\n\nclaims of two: 1 not measured\n"), Not(HasSubstr("‡"))));
    EXPECT_EQ(claims_to_text({}), "");
}

TEST(ClaimsFormats, MarkdownIsATableWithOneRowForEachFinding) {
    EXPECT_THAT(
        claims_to_markdown(all()),
        AllOf(
            StartsWith("**claims of exp: 1 reproduced, 1 not decided, 1 not measured**\n\n"),
            HasSubstr("\n| less \\| noise<br>note: a &lt;note> | Fig. 8 | ours/mis\\_2, mse at 16 "
                      "spp, said to be less than 1 | Box | ×0.63, within ours | ×0.600 [0.550, "
                      "0.650] | 10 | reproduced |\n"
                      "|  |  |  | Käfig | – | ×0.95 [0.80, 1.10] ‡ | 10 | not decided<br>about "
                      "14 more seeds may decide |\n")));
}

TEST(ClaimsFormats, HtmlJoinsTheRowsOfAClaimAndEscapesWhatItSays) {
    EXPECT_THAT(claims_to_html(all().front()),
                AllOf(HasSubstr("<th rowspan=\"2\">less | noise (Fig. 8)<small>ours/mis_2, mse"),
                      HasSubstr("<small>a &lt;note&gt;</small></th>"),
                      HasSubstr("<td class=\"better\"><span class=\"ratio\">reproduced</span>"),
                      HasSubstr("<td class=\"\"><span class=\"ratio\">not measured</span>"),
                      HasSubstr("<li>‡ the largest seed")));
}

TEST(ClaimsFormats, CsvHasOneRowOfAllFieldsForEachFinding) {
    const std::string csv = claims_to_csv(all());
    EXPECT_EQ(std::ranges::count(csv, '\n'), 4);
    EXPECT_THAT(csv, AllOf(StartsWith("experiment,claim,where,over,scene,scenes,method,against,"
                                      "metric,budget,expect,margin,paper,ratio,low,high,agrees_"
                                      "with_paper,seeds,is_paired,heavy_tail,few_passes,finding,"
                                      "reason,more_seeds,note\n"),
                           HasSubstr("\nexp,less | noise,Fig. 8,each,Box,Box Käfig,ours,mis_2,mse,"
                                     "16 spp,less,0.05,0.63,0.6,0.55,0.65,true,10,true,false,"
                                     "false,reproduced,,,a <note>\n"),
                           HasSubstr(",not_more,0.05,,,,,,1,false,false,false,not measured,\"Box, "
                                     "ours: 1 of 10 seeds: 9 unfinished\",,\n")));
    EXPECT_EQ(claims_to_csv({}), csv.substr(0, csv.find('\n') + 1));
}

TEST(ClaimsFormats, JsonHasNullWhereThereIsNothing) {
    const auto json = nlohmann::json::parse(claims_to_json(all()));
    ASSERT_EQ(json.size(), 3U);
    EXPECT_EQ(json.at(0).at("low"), 0.55);
    EXPECT_EQ(json.at(0).at("scenes"), (nlohmann::json{"Box", "Käfig"}));
    EXPECT_EQ(json.at(1).at("more_seeds"), 14);
    EXPECT_EQ(json.at(2).at("ratio"), nullptr);
    EXPECT_EQ(json.at(2).at("agrees_with_paper"), nullptr);
    EXPECT_EQ(claims_to_json({}), "[]\n");
}

}  // namespace
}  // namespace misbench
