// Profiles, several experiments in one run, and their claims, as processes.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kExperiment = R"(name: first
scenes: [CornellBox]
methods:
  bsdf: {method: path, max_depth: 3, nee: false}
  mis: {method: path, max_depth: 3}
seeds: 4
budgets: [{samples: 2}]
image: {width: 16, height: 12}
reference: {method: mis, samples: 64}
profiles:
  small: {}
  large: {seeds: 5, methods: {mis: {max_depth: 4}}}
claims:
  - {claim: next event estimation helps, where: Fig. 1, method: mis, expect: less, paper: 0.1}
  - {claim: it takes no time, method: mis, metric: seconds_per_pass, over: worst, expect: not_more}
)";

class ClaimsCliTest : public testing::Test {
 protected:
    void SetUp() override {
        std::ofstream(file("first.yaml")) << kExperiment;
        std::string second = kExperiment;
        second.replace(second.find("first"), 5, "second");
        second.erase(second.find("claims:"));
        std::ofstream(file("second.yaml")) << second;
        std::ofstream(file("lab.yaml")) << "name: lab\nproblems: []\n";
    }

    std::string file(const std::string& name) const { return (temporary_.path() / name).string(); }

    Outcome misbench(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, temporary_.path(), {}).wait();
    }

    Outcome run(std::vector<std::string> more) const {
        more.insert(more.begin(), "run");
        more.insert(more.end(), {"--store", file("store"), "--progress", "never"});
        return misbench(more);
    }

    static void expect_error(const Outcome& outcome, const std::string& message) {
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }

 private:
    TemporaryFolder temporary_;
};

TEST_F(ClaimsCliTest, PlanTakesAProfileAndShowsAll) {
    EXPECT_THAT(
        misbench({"plan", file("first.yaml")}).out,
        AllOf(HasSubstr("\nprofile small (known: small large)\n"), HasSubstr("\nfirst: 10 tasks")));
    EXPECT_THAT(misbench({"plan", file("first.yaml"), "--profile", "large"}).out,
                AllOf(HasSubstr("\nprofile large (known: small large)\n"),
                      HasSubstr("\nfirst-large: 12 tasks")));
    const auto json = nlohmann::json::parse(
        misbench({"plan", file("first.yaml"), "--profile", "large", "--set", "seeds=1", "--json"})
            .out);
    EXPECT_EQ(json.at("profile"), "large");
    EXPECT_EQ(json.at("profiles"), (nlohmann::json{"small", "large"}));
    EXPECT_EQ(json.at("tasks"), 4);
    expect_error(misbench({"plan", file("first.yaml"), "--profile", "huge"}),
                 "--profile huge: unknown profile 'huge'; known: small large");
    expect_error(misbench({"plan", file("lab.yaml")}),
                 "lab.yaml:2:1: a file for `misbench lab`, not an experiment");
}

TEST_F(ClaimsCliTest, RunPrintsClaimsWhichTheStoreKeeps) {
    // At fewer samples one seed of four carries the error, which decides nothing.
    const Outcome first = run({file("first.yaml"), "--set", "budgets=[{samples: 64}]"});
    ASSERT_EQ(first.exit_code, 0) << first.err;
    const std::size_t at = first.out.find("\nclaims of first: ");
    ASSERT_NE(at, std::string::npos) << first.out;
    const std::string claims = first.out.substr(at + 1);
    EXPECT_THAT(claims, AllOf(HasSubstr("\nnext event estimation helps (Fig. 1)\n"),
                              ContainsRegex("\n  reproduced +CornellBox +×0.0.*paper ×0.1"),
                              HasSubstr("worst of 1 scene: CornellBox")));
    EXPECT_EQ(misbench({"claims", file("store")}).out, claims);
    EXPECT_EQ(misbench({"claims", file("store"), "--experiment", "first"}).out, claims);
    ASSERT_EQ(misbench({"report", file("store")}).exit_code, 0);
    const std::string html = slurp(file("store/report.html"));
    EXPECT_LT(html.find("<h2>Claims</h2>"), html.find("<h2>Results</h2>"));
    EXPECT_THAT(html, HasSubstr("next event estimation helps (Fig. 1)"));

    fs::remove(file("store/results.sqlite"));
    ASSERT_EQ(misbench({"reindex", file("store")}).exit_code, 0);
    EXPECT_EQ(misbench({"claims", file("store")}).out, claims);
    EXPECT_THAT(misbench({"claims", file("store"), "--format", "csv"}).out,
                HasSubstr("\nfirst,next event estimation helps,Fig. 1,each,CornellBox,"));
    EXPECT_THAT(misbench({"claims", file("store"), "--format", "markdown"}).out,
                HasSubstr("\n| next event estimation helps | Fig. 1 |"));
    const auto json =
        nlohmann::json::parse(misbench({"claims", file("store"), "--format", "json"}).out);
    EXPECT_EQ(json.size(), 2U);
    EXPECT_EQ(json.at(0).at("finding"), "reproduced");

    expect_error(misbench({"claims", file("store"), "--experiment", "other"}), "first");
    expect_error(misbench({"claims", file("store"), "--format", "latex"}), "--format");
    expect_error(misbench({"claims", file("nowhere")}), "nowhere");
}

TEST_F(ClaimsCliTest, AClaimMayBeAboutImagesThatAreImportedLater) {
    std::string own = slurp(file("first.yaml"));
    own.erase(own.find("  - {claim: it takes"));
    own.replace(own.find("method: mis, expect: less"), 25,
                "method: imported:theirs, against: mis, expect: more");
    std::ofstream(file("own.yaml")) << own;
    const Outcome before = run({file("own.yaml"), "--set", "budgets=[{samples: 64}]"});
    ASSERT_EQ(before.exit_code, 0) << before.err;
    EXPECT_THAT(before.out, HasSubstr("CornellBox, theirs: no images are imported"));
    for (const std::string seed : {"1", "2", "3", "4"}) {
        ASSERT_EQ(misbench({"render", "CornellBox", "--method", "path", "--set", "nee=false",
                            "--spp", "64", "--size", "16x12", "--seed", seed, "-o",
                            file("theirs-" + seed + ".exr")})
                      .exit_code,
                  0);
    }
    const Outcome imported =
        misbench({"import", file("store"), "--experiment", "first", "--scene", "CornellBox",
                  "--pattern", "{method}-{seed}.exr", file("."), "--samples", "64"});
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    EXPECT_THAT(misbench({"claims", file("store")}).out,
                AllOf(HasSubstr("claims of first: 1 reproduced"), HasSubstr("theirs/mis")));
    expect_error(misbench({"import", file("store"), "--experiment", "first", "--remove", "theirs"}),
                 "the claim 'next event estimation helps' is about 'theirs'");
    own.replace(own.find("imported:theirs"), 15, "imported:bsdf");
    std::ofstream(file("own.yaml")) << own;
    expect_error(run({file("own.yaml")}), "'bsdf' is a method of this file");
}

TEST_F(ClaimsCliTest, SeveralFilesRunIntoOneStoreAndThoseOfTheLabArePassedOver) {
    const Outcome both = run({file("second.yaml"), file("lab.yaml"), file("first.yaml"),
                              "--profile", "large", "--set", "seeds=3"});
    ASSERT_EQ(both.exit_code, 0) << both.err;
    EXPECT_EQ(both.err,
              "misbench: passed over '" + file("lab.yaml") + "': a file for `misbench lab`\n");
    EXPECT_LT(both.out.find("second-large: relmse"), both.out.find("first-large: relmse"));
    EXPECT_THAT(both.out, HasSubstr("\nclaims of first-large: "));
    EXPECT_THAT(misbench({"status", file("store")}).out,
                AllOf(ContainsRegex("first-large +8 +8 +0"), ContainsRegex("second-large +8 +8")));
    EXPECT_THAT(misbench({"claims", file("store")}).out, StartsWith("claims of first-large: "));
    const Outcome none = misbench({"claims", file("store"), "--experiment", "second-large"});
    EXPECT_EQ(none.exit_code, 0);
    EXPECT_EQ(none.out, "");
    EXPECT_EQ(none.err, "misbench: no experiment here makes a claim\n");
}

TEST_F(ClaimsCliTest, WhatIsWrongWithAnyFileIsSaidBeforeTheFirstRuns) {
    std::ofstream(file("broken.yaml")) << "name: broken\n";
    expect_error(run({file("first.yaml"), file("broken.yaml")}), "broken.yaml:1:1: ");
    expect_error(run({file("first.yaml"), file("first.yaml")}),
                 "first.yaml: a second experiment of the name 'first'");
    expect_error(run({file("lab.yaml")}), "lab.yaml:2:1: a file for `misbench lab`");
    EXPECT_FALSE(fs::exists(file("store")));
}

TEST_F(ClaimsCliTest, TheExitCodeOfSeveralFilesIsTheWorst) {
    fs::create_directories(file("scenes"));
    fs::copy(MISBENCH_SCENES "/VeachMIS", file("scenes/VeachMIS"), fs::copy_options::recursive);
    fs::copy(MISBENCH_SCENES "/CornellBox", file("scenes/CornellBox"), fs::copy_options::recursive);
    fs::resize_file(file("scenes/VeachMIS/meshes/mesh3.ply"), 300);
    std::string failing = slurp(file("first.yaml"));
    failing.replace(failing.find("first"), 5, "fails");
    failing.replace(failing.find("CornellBox"), 10, "VeachMIS");
    std::ofstream(file("fails.yaml")) << failing;
    const Outcome outcome = run(
        {file("fails.yaml"), file("second.yaml"), "--scenes", file("scenes"), "--set", "seeds=1"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("claims of fails: 2 not measured"), HasSubstr("second: relmse"),
                      Not(HasSubstr("claims of second"))));
}

}  // namespace
}  // namespace misbench
