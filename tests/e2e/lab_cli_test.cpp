// misbench lab as a process, and every laboratory file of the repository.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class LabCliTest : public testing::Test {
 protected:
    std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

    Outcome lab(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {MISBENCH_PROGRAM, "lab"});
        return Process(arguments, folder_.path()).wait();
    }

    void expect_error(const Outcome& outcome, const std::string& message) const {
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("misbench: error: "), HasSubstr(message)));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }

    TemporaryFolder folder_;
};

// The files of experiments/ that have problems are the laboratory's.
std::vector<fs::path> laboratory_files() {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(MISBENCH_EXPERIMENTS)) {
        if (entry.path().extension() != ".yaml") continue;
        if (slurp(entry.path()).find("\nproblems:") != std::string::npos) {
            files.push_back(entry.path());
        }
    }
    return files;
}

TEST_F(LabCliTest, EveryLaboratoryFileOfTheRepositoryRuns) {
    const std::vector<fs::path> files = laboratory_files();
    EXPECT_GE(files.size(), 3U);
    for (const fs::path& path : files) {
        std::vector<std::string> arguments{path, "--format", "json", "--set", "runs=50"};
        if (slurp(path).find("  correction:") != std::string::npos) {
            arguments.insert(arguments.end(),
                             {"--set", "weights.correction.correction.candidates=4"});
        }
        const Outcome outcome = lab(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        const auto json = nlohmann::json::parse(outcome.out);
        for (const auto& problem : json["problems"]) {
            EXPECT_FALSE(problem["expectations"].empty()) << path;
            for (const auto& weights : problem["weights"]) {
                EXPECT_TRUE(weights["error"].is_number()) << path << weights;
            }
        }
    }
}

constexpr const char* kFile = R"(name: tiny
runs: 100
weights:
  balance: {heuristic: balance}
  "odd, name": {only: one}
  direct: {optimal: direct, iterations: 4}
problems:
  flat:
    integrand: {shape: uniform}
    techniques:
      one: {density: {shape: linear, from: 0.5, to: 1.5}}
      two: {density: {shape: uniform}, samples: 3}
    expect:
      - {claim: balance is better, less: [balance, 'odd, name']}
      - {claim: it is worse, less: ['odd, name', balance], note: of course not}
)";

TEST_F(LabCliTest, PrintsATableAndWhichExpectationsHold) {
    const std::string path = folder_.write("tiny.yaml", kFile);
    const Outcome text = lab({path, "-o", file("tiny.svg")});
    EXPECT_EQ(text.exit_code, 0);
    EXPECT_EQ(text.err, "");
    EXPECT_THAT(text.out, AllOf(StartsWith("flat: integral 1\n"), HasSubstr("\nbalance "),
                                HasSubstr("one 1, two 1"), HasSubstr("\nholds: balance is better"),
                                HasSubstr("\ndoes not hold: it is worse ("),
                                HasSubstr("; note: of course not\n")));
    EXPECT_THAT(slurp(file("tiny.svg")), AllOf(StartsWith("<svg "), HasSubstr(">flat<")));
    EXPECT_EQ(lab({path}).out, text.out);
    EXPECT_NE(lab({path, "--set", "seed=2"}).out, text.out);
}

TEST_F(LabCliTest, HasEveryNumberAsJsonAndCsv) {
    const std::string path = folder_.write("tiny.yaml", kFile);
    const auto json = nlohmann::json::parse(lab({path, "--format", "json"}).out);
    const auto& weights = json["problems"][0]["weights"];
    ASSERT_EQ(weights.size(), 3U);
    EXPECT_EQ(weights[0]["factors"]["two"], 1);
    EXPECT_GT(weights[1]["exact"]["variance"], weights[0]["exact"]["variance"]);
    EXPECT_TRUE(weights[2]["exact"].is_null());
    EXPECT_GT(weights[2]["sampled_variance"]["value"], 0);
    EXPECT_EQ(json["problems"][0]["expectations"][0]["holds"], true);

    const std::string csv = lab({path, "--format", "csv"}).out;
    EXPECT_EQ(std::ranges::count(csv, '\n'), 4);
    EXPECT_THAT(
        csv, AllOf(StartsWith("problem,weights,integral,"), HasSubstr("flat,\"odd, name\",1,1,")));
    const std::ptrdiff_t n_commas = std::ranges::count(csv.substr(0, csv.find('\n')), ',');
    const std::string last = csv.substr(csv.find("flat,direct"));
    EXPECT_EQ(std::ranges::count(last, ','), n_commas);
}

TEST_F(LabCliTest, ErrorsAreOneLineWithThePlace) {
    const std::string path = folder_.write("tiny.yaml", kFile);
    expect_error(lab({file("none.yaml")}), "none.yaml");
    EXPECT_THAT(lab({"--help"}).out, HasSubstr("Usage"));
    expect_error(lab({}), "file");
    expect_error(lab({path, "--format", "pdf"}), "pdf");
    expect_error(lab({path, "-o", file("tiny.png")}), ".svg only");
    expect_error(lab({path, "--set", "runs=-1"}), "runs");
    expect_error(lab({path, "--set", "weights.balance.heuristic=ballance"}),
                 "unknown MIS heuristic 'ballance'");
    expect_error(lab({folder_.write("bad.yaml", "name: x\nproblem: {}\n")}), "bad.yaml:2:1");
}

}  // namespace
}  // namespace misbench
