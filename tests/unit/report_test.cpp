// What a report holds: pixels without loss beyond what is stated, numbers, doubts, nothing from
// outside.
#include "experiments/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "experiments/report/doubts.h"
#include "experiments/report/report_data.h"
#include "experiments/statistics/bootstrap.h"
#include "results/schema.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// --- decoding, after pixel_block.h and RFC 4648, 1951 --------------------------------------------

std::string inflate_raw(const std::string& packed, std::size_t size) {
    std::string bytes(size + 1, '\0');
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, -MAX_WBITS), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = static_cast<uInt>(bytes.size());
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    bytes.resize(stream.total_out);
    inflateEnd(&stream);
    EXPECT_EQ(bytes.size(), size);
    return bytes;
}

double half_to_double(std::uint32_t bits) {
    const double sign = (bits & 0x8000U) != 0 ? -1 : 1;
    const auto exponent = static_cast<int>(bits >> 10U & 31U);
    const double fraction = bits & 1023U;
    if (exponent == 31) {
        return fraction == 0 ? sign * std::numeric_limits<double>::infinity()
                             : std::numeric_limits<double>::quiet_NaN();
    }
    if (exponent == 0) return sign * std::ldexp(fraction, -24);
    return sign * std::ldexp(1 + fraction / 1024, exponent - 15);
}

std::vector<double> decode(const PixelBlock& block, std::size_t n_pixels) {
    const std::size_t n_bytes = block.precision == Precision::Half ? 2 : 4;
    const std::string bytes = inflate_raw(block.bytes, 3 * n_bytes * n_pixels);
    const auto bits_of = [&](std::size_t plane, std::size_t pixel) {
        std::uint32_t bits = 0;
        for (std::size_t b = 0; b < n_bytes; ++b) {
            bits = bits << 8U |
                   static_cast<unsigned char>(bytes[(plane * n_bytes + b) * n_pixels + pixel]);
        }
        return bits;
    };
    std::vector<double> values;
    for (std::size_t p = 0; p < n_pixels; ++p) {
        for (std::size_t c = 0; c < 3; ++c) {
            std::uint32_t bits = bits_of(c, p);
            if (c != 1) bits += bits_of(1, p);
            values.push_back(block.precision == Precision::Half
                                 ? half_to_double(bits & 0xFFFFU) / block.scale
                                 : static_cast<double>(std::bit_cast<float>(bits)));
        }
    }
    return values;
}

Image image_of_magnitude(double magnitude) {
    Image image(37, 11);
    std::mt19937 random(5);
    std::lognormal_distribution<double> noise(0, 2);
    for (float& value : image.rgb) value = static_cast<float>(magnitude * noise(random));
    image.rgb[4] = 0;
    image.rgb[5] = -image.rgb[5];
    return image;
}

TEST(PixelBlock, HalfFloatsAreOffByAtMostWhatTheySayWhateverTheMagnitude) {
    for (const double magnitude : {1e-30, 1e-6, 1.0, 1e6, 1e30}) {
        const Image image = image_of_magnitude(magnitude);
        const PixelBlock block = pack_pixels(image, Precision::Half);
        const std::vector<double> decoded = decode(block, image.n_pixels());
        for (std::size_t i = 0; i < decoded.size(); ++i) {
            const auto exact = static_cast<double>(image.rgb[i]);
            EXPECT_LE(std::abs(decoded[i] - exact), std::exp2(-11) * std::abs(exact)) << magnitude;
        }
    }
}

TEST(PixelBlock, FarBelowTheLargestValueAnErrorIsAbsolute) {
    Image image(2, 1);
    image.rgb = {6e7F, 1.0F, 0.1F, 1e-3F, 1e-9F, 65504.0F};
    const std::vector<double> decoded = decode(pack_pixels(image, Precision::Half), 2);
    for (std::size_t i = 0; i < decoded.size(); ++i) {
        const auto exact = static_cast<double>(image.rgb[i]);
        const double allowed = std::max(std::exp2(-11) * exact, std::exp2(-40) * 6e7);
        EXPECT_LE(std::abs(decoded[i] - exact), allowed) << exact;
    }
}

TEST(PixelBlock, FloatsAreKeptBitByBit) {
    const Image image = image_of_magnitude(1e-3);
    const std::vector<double> decoded =
        decode(pack_pixels(image, Precision::Float), image.n_pixels());
    for (std::size_t i = 0; i < decoded.size(); ++i) {
        EXPECT_EQ(decoded[i], static_cast<double>(image.rgb[i]));
    }
}

TEST(PixelBlock, KeepsWhatIsNotFinite) {
    Image image = image_of_magnitude(1);
    const float infinity = std::numeric_limits<float>::infinity();
    image.rgb[0] = std::numeric_limits<float>::quiet_NaN();
    image.rgb[1] = infinity;
    image.rgb[2] = -infinity;
    for (const Precision precision : {Precision::Half, Precision::Float}) {
        const std::vector<double> decoded = decode(pack_pixels(image, precision), 37 * 11);
        EXPECT_TRUE(std::isnan(decoded[0]));
        EXPECT_EQ(decoded[1], std::numeric_limits<double>::infinity());
        EXPECT_EQ(decoded[2], -std::numeric_limits<double>::infinity());
        EXPECT_TRUE(std::isfinite(decoded[3]));
    }
}

TEST(PixelBlock, ABlackImageIsBlack) {
    const std::vector<double> decoded = decode(pack_pixels(Image(3, 2), Precision::Half), 6);
    EXPECT_THAT(decoded, testing::Each(0.0));
}

// --- reports -------------------------------------------------------------------------------------

class ReportTest : public testing::Test {
 protected:
    ReportTest() : plan_(made_up_plan("small", 3)) {
        const auto method =
            nlohmann::json{{"method", "path"}, {"version", 1}, {"parameters", {{"max_depth", 3}}}};
        plan_.configuration = nlohmann::json{
            {"methods", {{"plain", method}, {"clever", method}}},
            {"reference", method}}.dump();
        store_.put_experiment(plan_);
    }

    void commit_and_measure(const RecordChange& change = {}) {
        for (const Cell& cell : plan_.cells) commit_made_up_run(store_, cell.task, change);
        store_.measure(plan_);
    }

    static nlohmann::json data_of(const Report& report) {
        const std::string begin = R"(<script type="application/json" id="data">)";
        const std::size_t at = report.html.find(begin) + begin.size();
        return nlohmann::json::parse(
            report.html.substr(at, report.html.find("</script>", at) - at));
    }

    nlohmann::json data(SeedImages seeds) {
        return data_of(make_report(store_, plan_, {.seeds = seeds}));
    }

    TemporaryFolder folder_;
    Store store_{folder_.path() / "store", Store::Access::ReadWrite};
    Plan plan_;
};

TEST_F(ReportTest, HasTheImagesThatAreAskedFor) {
    commit_and_measure();
    EXPECT_EQ(data(SeedImages::None).at("images").size(), 1U + 2 * 1);
    EXPECT_EQ(data(SeedImages::First).at("images").size(), 1U + 2 * 2);
    const nlohmann::json all = data(SeedImages::All);
    EXPECT_EQ(all.at("images").size(), 1U + 2 * 4);
    EXPECT_EQ(all.at("blocks").size(), 1U + 2 * 4);
    EXPECT_THAT(all.at("images").at(1).at("caption").get<std::string>(),
                HasSubstr("plain, 16 spp, mean of 3 seeds; a seed's relmse.eps0.01 0."));
    EXPECT_THAT(all.at("images").at(2).at("caption").get<std::string>(),
                HasSubstr("plain, 16 spp, seed 1: 16 spp in 2.75 s cpu"));
}

TEST_F(ReportTest, HoldsTheNumbersOfEveryMetric) {
    commit_and_measure();
    const nlohmann::json metrics = data(SeedImages::None).at("metrics");
    ASSERT_EQ(metrics.size(), 2U);
    const Comparison mse = compare(store_, plan_, "mse");
    EXPECT_EQ(metrics.at(1).at("cells").at(1).at("mean").at("value"), mse.cells[1].mean->value);
    EXPECT_EQ(metrics.at(1).at("curves").at(1).at("points").at(0).at("value"),
              mse.cells[1].mean->value);
}

TEST_F(ReportTest, TheSameStoreGivesTheSameBytes) {
    commit_and_measure();
    EXPECT_EQ(make_report(store_, plan_).html, make_report(store_, plan_).html);
}

TEST_F(ReportTest, NeedsNothingFromOutside) {
    commit_and_measure();
    const std::string html = make_report(store_, plan_).html;
    for (const char* outside : {"src=", "@import", "url(", "href=\"h", "href=\"/", "{{"}) {
        EXPECT_THAT(html, Not(HasSubstr(outside)));
    }
    EXPECT_THAT(html, HasSubstr("Released under the MIT License"));
}

TEST_F(ReportTest, NothingFromTheStoreEndsAScriptOrStartsAnElement) {
    plan_.description = "</script><b>";
    plan_.scenes[0].name = "</script><i>";
    for (Cell& cell : plan_.cells) cell.scene = plan_.scenes[0].name;
    store_.put_experiment(plan_);
    commit_and_measure();
    const Report report = make_report(store_, plan_);
    EXPECT_THAT(report.html, Not(HasSubstr("</script><")));
    EXPECT_EQ(data_of(report).at("scenes").at(0).at("name"), "</script><i>");
}

TEST_F(ReportTest, IsMadeOfARunThatHasHardlyBegun) {
    EXPECT_EQ(make_report(store_, plan_).n_images, 0U);
    commit_made_up_run(store_, plan_.cells[2].task);
    const Report report = make_report(
        store_, plan_,
        {.running = Running{.n_tasks = 8, .n_done = 1, .n_failed = 0, .reload_seconds = 2}});
    EXPECT_EQ(report.n_images, 2U);  // the mean of one seed is that seed's image
    EXPECT_EQ(data_of(report).at("blocks").size(), 1U);
    EXPECT_EQ(data_of(report).at("running"),
              (nlohmann::json{{"tasks", 8}, {"done", 1}, {"failed", 0}, {"reload_seconds", 2}}));
    EXPECT_EQ(data_of(make_report(store_, plan_)).at("running"), nullptr);
}

TEST_F(ReportTest, ShowsAnInvalidRunOnlyAsItself) {
    const std::string first = task_id(plan_.cells[2].task);
    commit_and_measure([&first](Record& record) {
        if (record.run != first) return;
        record.valid = false;
        record.statistics.nonfinite_samples = 3;
    });
    const nlohmann::json images = data(SeedImages::First).at("images");
    EXPECT_THAT(images.at(1).at("caption").get<std::string>(), HasSubstr("mean of 2 seeds"));
    EXPECT_THAT(images.at(2).at("caption").get<std::string>(), HasSubstr("INVALID run"));
    const std::vector<Doubt> found = doubts(store_, plan_, compare(store_, plan_));
    ASSERT_EQ(found.size(), 3U);  // steal, which every made-up run has
    EXPECT_THAT(found[0].cases, testing::ElementsAre(HasSubstr("3 non-finite")));
    EXPECT_THAT(found[1].cases,
                testing::ElementsAre("Box, plain, 16 spp: 2 of 3 seeds: 1 invalid"));
}

TEST_F(ReportTest, DoubtsAReferenceOfFewerSamplesThanARun) {
    const std::int64_t first_seed = plan_.cells[2].seed;
    commit_and_measure([first_seed](Record& record) {
        record.statistics.steal_seconds = 0;
        if (record.task.seed == first_seed) record.statistics.passes = 33;
    });
    const std::vector<Doubt> found = doubts(store_, plan_, compare(store_, plan_));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_THAT(found[0].cases, Contains("Box: 32 spp, and a run has 33"));
}

TEST_F(ReportTest, DoubtsRareSeedsThatCarryTheErrorAndNoisyReferences) {
    for (Cell& cell : plan_.cells) {
        if (cell.role != Role::Test) cell.budget = cell.task.budget = SampleBudget{64};
    }
    store_.put_experiment(plan_);
    commit_and_measure([](Record& record) { record.statistics.steal_seconds = 0; });
    open_database(folder_.path() / "store/results.sqlite", Database::Access::ReadWrite)
        ->prepare("UPDATE measurements SET value = 50 * value WHERE run = ?1")
        .bind(task_id(plan_.cells[2].task))
        .run();
    const std::vector<Doubt> found = doubts(store_, plan_, compare(store_, plan_));
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].kind, "no interval: " + to_string(NoInterval::HeavyTail));
    EXPECT_THAT(found[0].cases, testing::ElementsAre(testing::MatchesRegex(
                                    "Box, plain, 16 spp: the largest is [0-9.]+ times the "
                                    "median")));
    EXPECT_THAT(found[1].kind, HasSubstr("misbench reference STORE --improve"));
    EXPECT_THAT(found[1].cases, Contains(testing::MatchesRegex("Box, clever, 16 spp: [0-9]+ %")));
    const Report report = make_report(store_, plan_);
    EXPECT_THAT(report.html, HasSubstr("rare seeds carry a mean, and fewer than two of them"));
    EXPECT_THAT(report.html, HasSubstr(" §</span>"));
    const nlohmann::json clever = data_of(report).at("metrics").at(0).at("cells").at(1);
    EXPECT_EQ(clever.at("ratio").at("no_interval"), to_string(NoInterval::HeavyTail));
    EXPECT_EQ(clever.at("noisy_reference"), true);
}

TEST_F(ReportTest, DoubtsRatiosOnWhichTheIntervalsDisagree) {
    plan_ = made_up_plan("first", 6);
    store_.put_experiment(plan_);
    commit_and_measure([](Record& record) { record.statistics.steal_seconds = 0; });
    Comparison comparison = compare(store_, plan_);
    const auto disputed = [&] {
        std::vector<std::string> cases;
        for (const Doubt& doubt : doubts(store_, plan_, comparison)) {
            if (doubt.kind.find("bootstrap-t") != std::string::npos) cases = doubt.cases;
        }
        return cases;
    };
    EXPECT_THAT(disputed(), testing::IsEmpty());  // both exclude 1
    ComparedCell& clever = comparison.cells[1];
    const Estimate check = *bootstrap_ratio(clever, comparison.cells[0]);
    EXPECT_EQ(check, *bootstrap_paired_ratio(clever.values, comparison.cells[0].values));
    clever.ratio->interval->high = 1.1;
    EXPECT_THAT(disputed(), testing::ElementsAre(testing::MatchesRegex(
                                "Box, clever, 16 spp: ×0.* 1.1], bootstrap-t .0.*]")));
}

TEST_F(ReportTest, SumsUpWhatDisturbedTheRuns) {
    commit_and_measure();
    const std::vector<std::string> lines = disturbance_lines(store_, plan_);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_THAT(lines[0], HasSubstr("42 involuntary context switches in 16.5 CPU seconds"));
    EXPECT_THAT(lines[1], HasSubstr("3 s stolen"));
}

}  // namespace
}  // namespace misbench
