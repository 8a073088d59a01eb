#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "renderer/base/base64.h"
#include "renderer/base/budget.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/parameters.h"
#include "renderer/base/rng.h"
#include "renderer/base/sha256.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class Files : public testing::Test {
 protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("misbench_files_" + std::to_string(::getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_;
};

// Test vectors of FIPS 180-2, appendix B.
TEST(Sha256, AgreesWithItsStandard) {
    EXPECT_EQ(sha256_hex("abc"),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    Sha256 in_parts;
    in_parts.update("a");
    in_parts.update("bc");
    EXPECT_EQ(in_parts.hex(), sha256_hex("abc"));
}

// Test vectors of RFC 4648, section 10, and the two digits that URLs write otherwise.
TEST(Base64, AgreesWithItsStandard) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xfb\xff"), "+/8=");
}

TEST_F(Files, AreReadAsTheyWereWritten) {
    const std::string bytes("a\0\n\r\xff", 5);
    write_file_durably(folder_ / "f", bytes);
    EXPECT_EQ(read_file(folder_ / "f"), bytes);
    write_file_durably(folder_ / "f", "");
    EXPECT_EQ(read_file(folder_ / "f"), "");
}

TEST_F(Files, LeaveNothingBehindWhenTheyCannotBeWritten) {
    EXPECT_THROW(write_file_durably(folder_ / "no" / "f", "x"), Error);
    fs::create_directory(folder_ / "taken");
    fs::create_directory(folder_ / "taken" / "child");
    EXPECT_THROW(write_file_durably(folder_ / "taken", "x"), Error);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(Files, ThatAreMissingAreNamed) {
    EXPECT_THAT([this] { read_file(folder_ / "missing"); },
                ThrowsMessage<Error>(HasSubstr("missing': no such file")));
}

TEST_F(Files, ALockIsHeldByOneProcessAndNamesIt) {
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        const FileLock lock(folder_ / "lock");
        (void)!::write(ready[1], "r", 1);
        ::pause();
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    EXPECT_THAT([this] { const FileLock second(folder_ / "lock"); },
                ThrowsMessage<Error>(HasSubstr("in use by process " + std::to_string(child))));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    EXPECT_NO_THROW(const FileLock free(folder_ / "lock"));
}

TEST(Parameters, KeepTheirTypesThroughJson) {
    const ParameterMap map = {
        {"b", true}, {"i", std::int64_t{3}}, {"d", 3.0}, {"s", std::string("x")}, {"t", 0.1}};
    EXPECT_EQ(parameters_from_json(nlohmann::json::parse(parameters_to_json(map).dump())), map);
    EXPECT_EQ(to_string(ParameterValue(0.1)), "0.1");
    EXPECT_EQ(to_string(ParameterValue(true)), "true");
}

TEST(Budget, KeepsItsKindThroughJson) {
    for (const Budget& budget : {Budget(SampleBudget{16}), Budget(TimeBudget{2, BudgetClock::Cpu}),
                                 Budget(TimeBudget{0.5, BudgetClock::Wall})}) {
        EXPECT_EQ(budget_from_json(budget_to_json(budget)), budget);
    }
    EXPECT_EQ(to_string(Budget(SampleBudget{16})), "16 spp");
    EXPECT_EQ(to_string(Budget(TimeBudget{2, BudgetClock::Cpu})), "2 s cpu");
    EXPECT_EQ(to_string(Budget(TimeBudget{0.5, BudgetClock::Wall})), "0.5 s wall");
}

TEST(Error, HasTheExitCodeThatIsDocumented) {
    EXPECT_EQ(exit_code(Errc::InvalidArgument), 2);
    EXPECT_EQ(exit_code(Errc::NotFound), 2);
    EXPECT_EQ(exit_code(Errc::FailedPrecondition), 3);
    EXPECT_EQ(exit_code(Errc::DataLoss), 3);
    EXPECT_EQ(exit_code(Errc::Unavailable), 4);
    EXPECT_EQ(exit_code(Errc::Internal), 70);
}

TEST(Rng, RepeatsItselfForEqualKeysOnly) {
    const auto first = [](std::int64_t seed, std::uint32_t pixel, std::uint32_t pass) {
        return Rng(seed, pixel, pass).uniform();
    };
    EXPECT_EQ(first(1, 2, 3), first(1, 2, 3));
    EXPECT_NE(first(1, 2, 3), first(2, 2, 3));
    EXPECT_NE(first(1, 2, 3), first(1, 3, 3));
    EXPECT_NE(first(1, 2, 3), first(1, 2, 4));
    EXPECT_NE(first(1, 2, 3), first((std::int64_t{1} << 32) + 1, 2, 3)) << "high half of the seed";
}

TEST(Rng, IsUniformOnTheHalfOpenInterval) {
    Rng rng(7, 0, 0);
    double sum = 0;
    double sum_of_products = 0;
    float previous = 0.5F;
    constexpr int kN = 1 << 20;
    for (int i = 0; i < kN; ++i) {
        const float u = rng.uniform();
        ASSERT_TRUE(u >= 0 && u < 1);
        sum += double{u};
        sum_of_products += (double{u} - 0.5) * (double{previous} - 0.5);
        previous = u;
    }
    EXPECT_NEAR(sum / kN, 0.5, 5 * std::sqrt(1.0 / 12 / kN));
    EXPECT_NEAR(sum_of_products / kN, 0, 5 * (1.0 / 12) / std::sqrt(double{kN}));
}

}  // namespace
}  // namespace misbench
