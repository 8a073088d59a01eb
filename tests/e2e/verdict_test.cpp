// What a user is told of differences, as processes: which are there, which are not, and which
// nobody could know.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "results/schema.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

// Photons are gathered within nearly half of the one scene, and a hundredth of the other.
constexpr const char* kExperiment = R"(name: verdicts
scenes: [CornellBox, {scene: Box/LightCenter, parameters: {radius_scale: 0.01}}]
image: {width: 48, height: 36}
methods:
  mis: {method: path, max_depth: 5}
  nee: {method: path, max_depth: 5, bsdf: false}
  bdpt: {method: bdpt, max_depth: 5}
  blurred: {method: photon, max_depth: 5, radius: global, radius_scale: 0.4}
seeds: 12
budgets: [{samples: 16}]
reference: {method: mis, samples: 512}
)";

class VerdictTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        folder_->write("verdicts.yaml", kExperiment);
        const Outcome outcome = misbench({"run", file("verdicts.yaml"), "--store", file("store"),
                                          "--workers", "2", "--progress", "never"});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static std::string file(const std::string& name) { return (folder_->path() / name).string(); }

    static Outcome misbench(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), MISBENCH_PROGRAM);
        return Process(arguments, folder_->path()).wait();
    }
    static std::string result_of(const std::vector<std::string>& arguments) {
        const Outcome outcome = misbench(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        return outcome.out;
    }
    static void expect_error(const Outcome& outcome, const std::string& message) {
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_THAT(outcome.err,
                    AllOf(testing::StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    }

    inline static std::unique_ptr<TemporaryFolder> folder_;
};

// --- bias ----------------------------------------------------------------------------------------

TEST_F(VerdictTest, BiasIsFoundInTheMethodAndTheSceneThatHaveIt) {
    const auto json = nlohmann::json::parse(result_of({"bias", file("store"), "--format", "json"}));
    ASSERT_EQ(json.at("cells").size(), 6U);
    for (const auto& cell : json.at("cells")) {
        const bool has_bias = cell.at("method") == "blurred" && cell.at("scene") == "CornellBox";
        EXPECT_EQ(cell.at("finding") == "biased", has_bias) << cell.dump();
        EXPECT_EQ(cell.at("seeds"), 12);
    }
    EXPECT_THAT(result_of({"bias", file("store")}),
                AllOf(HasSubstr("bias of verdicts against mis at 16 spp\n"),
                      ContainsRegex("CornellBox +blurred +12 pairs +biased \\*"),
                      Not(ContainsRegex("(nee|bdpt) +12 pairs +biased"))));
    result_of({"bias", file("store"), "--maps", file("maps")});
    EXPECT_TRUE(std::filesystem::exists(file("maps/CornellBox-blurred.png")));
    expect_error(misbench({"bias", file("store"), "--against", "pt"}), "'pt'; known: 'mis'");
    expect_error(misbench({"bias", file("store"), "--budget", "5 spp"}), "known: '16 spp'");
    expect_error(misbench({"bias", file("nowhere")}), "nowhere");
}

// --- the comparison's test of itself -------------------------------------------------------------

// The shares behind each occurrence of `what`.
std::vector<double> shares_of(const std::string& text, const std::string& what) {
    std::vector<double> shares;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
        shares.push_back(std::stod(text.substr(at + what.size())));
    }
    return shares;
}

TEST_F(VerdictTest, SelftestFindsNothingBetweenHalvesAndOftenWhatIsPlanted) {
    const std::string text = result_of({"selftest", file("store")});
    EXPECT_THAT(text, AllOf(HasSubstr("self-test of verdicts, relmse.eps0.01: "),
                            HasSubstr("as far as 8 cells tell: the comparison passes"),
                            HasSubstr("a planted difference of 5 %")));
    const std::vector<double> alone = shares_of(text, "  each alone ");
    ASSERT_EQ(alone.size(), 2U);
    EXPECT_LE(alone[0], 10) << "twice the level";
    EXPECT_GT(alone[1], 2 * alone[0]);
    // Scene, method, budget, seeds, found where none is, by halves, power, and what it takes.
    std::istringstream rows(text.substr(text.find("\nCornellBox") + 1));
    for (int cell = 0; cell < 8; ++cell) {
        std::string word;
        int seeds = 0;
        int needed = 0;
        double power = 0;
        for (int i = 0; i < 4; ++i) rows >> word;
        rows >> seeds;
        for (int i = 0; i < 4; ++i) rows >> word;
        rows >> power >> word >> needed;
        EXPECT_EQ(seeds, 12);
        EXPECT_EQ(power >= 80, needed <= seeds) << "row " << cell << "\n" << text;
    }
    expect_error(misbench({"selftest", file("store"), "--metric", "psnr"}), "relmse.eps0.01");
    expect_error(misbench({"selftest", file("nowhere")}), "nowhere");
}

// --- tails and references ------------------------------------------------------------------------

TEST_F(VerdictTest, OneSeedThatCarriesTheErrorTakesTheIntervalAwayEverywhere) {
    std::filesystem::copy(file("store"), file("spiky"), std::filesystem::copy_options::recursive);
    const auto table = [](const std::string& format) {
        return result_of({"table", file("spiky"), "--ratio-to", "mis", "--format", format});
    };
    EXPECT_THAT(table("text"), Not(HasSubstr("rare seeds")));
    open_database(file("spiky/results.sqlite"), Database::Access::ReadWrite)
        ->execute(
            "UPDATE measurements SET value = 1000 * value WHERE run IN (SELECT task FROM cells "
            "WHERE scene = 'CornellBox' AND method = 'nee' AND seed = 7 AND role = 'test')");
    const std::string footnote = "no interval: rare seeds carry a mean, and fewer than two";
    for (const char* format : {"text", "markdown", "latex", "html"}) {
        EXPECT_THAT(table(format), HasSubstr(footnote)) << format;
    }
    const auto json = nlohmann::json::parse(table("json"));
    const auto& nee = json.at("cells").at(1);
    EXPECT_EQ(nee.at("method"), "nee");
    EXPECT_GT(nee.at("ratio").at("value"), 10);
    EXPECT_FALSE(nee.at("ratio").contains("interval"));
    EXPECT_EQ(nee.at("p"), nullptr);
    EXPECT_EQ(nee.at("tail_verdict"), "dishonest");
    EXPECT_THAT(result_of({"table", file("spiky"), "--metric", "tail(relmse.eps0.01)"}),
                AllOf(HasSubstr("verdicts: tail(relmse.eps0.01), 16 spp"), Not(HasSubstr("×"))));
    ASSERT_EQ(misbench({"report", file("spiky")}).exit_code, 0);
    EXPECT_THAT(slurp(file("spiky/report.html")), HasSubstr(footnote));
}

TEST_F(VerdictTest, ATableMarksWhatANoisyReferenceSpoils) {
    const Outcome run =
        misbench({"run", file("verdicts.yaml"), "--store", file("noisy"), "--set",
                  "reference.samples=8", "--set", "scenes=[CornellBox]", "--set", "seeds=3",
                  "--set", "budgets=[{samples: 4}]", "--progress", "never"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr(" §"), HasSubstr("misbench reference STORE --improve")));
    const std::string shares = result_of({"reference", file("noisy")});
    EXPECT_THAT(shares, ContainsRegex("CornellBox .*too noisy"));
    EXPECT_EQ(misbench({"reference", file("noisy"), "--improve", "64"}).exit_code, 0);
    EXPECT_THAT(result_of({"table", file("noisy")}), Not(HasSubstr("§")));
}

}  // namespace
}  // namespace misbench
