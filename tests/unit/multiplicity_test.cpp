#include "experiments/statistics/multiplicity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/statistics/intervals.h"

namespace misbench {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;
using Values = std::vector<double>;

// Fifteen p values of a trial of thrombolysis, the example of [BH95].
const Values kTrial = {0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344,
                       0.0459, 0.3240, 0.4262, 0.5719, 0.6528, 0.7590, 1.0000};

int n_below(const Values& p, double level) {
    return static_cast<int>(std::ranges::count_if(p, [level](double v) { return v <= level; }));
}

TEST(BenjaminiHochberg, FindsWhatThePaperFinds) {
    EXPECT_EQ(n_below(benjamini_hochberg(kTrial), 0.05), 4);
    EXPECT_EQ(n_below(holm(kTrial), 0.05), 3);
}

TEST(BenjaminiHochberg, AdjustsInTheOrderGivenAndNeverUpsideDown) {
    const Values p = {0.04, 0.01, 0.03, 0.9};
    const Values bh = {0.16 / 3, 0.04, 0.16 / 3, 0.9};
    EXPECT_THAT(benjamini_hochberg(p), Pointwise(DoubleNear(1e-15), bh));
    const Values by_holm = {0.09, 0.04, 0.09, 0.9};
    EXPECT_THAT(holm(p), Pointwise(DoubleNear(1e-15), by_holm));
}

TEST(BenjaminiHochberg, OfOneTestOrNoneChangesNothing) {
    EXPECT_THAT(benjamini_hochberg(Values{0.2}), ElementsAre(0.2));
    EXPECT_THAT(holm(Values{0.2}), ElementsAre(0.2));
    EXPECT_THAT(benjamini_hochberg(Values{}), ElementsAre());
    EXPECT_THAT(holm(Values{}), ElementsAre());
    EXPECT_THAT(benjamini_hochberg(Values{0, 1}), ElementsAre(0, 1));
}

TEST(BenjaminiHochberg, RefusesWhatIsNoProbability) {
    EXPECT_DEATH(benjamini_hochberg(Values{0.5, std::nan("")}), "check failed");
    EXPECT_DEATH(holm(Values{1.5}), "check failed");
}

// The p value and the interval are two views of one test.
TEST(PValue, IsTheLevelAtWhichTheIntervalEndsAtOne) {
    const LogRatio ratio = log_ratio(Values{1.0, 1.5, 1.25, 2.0}, Values{3.0, 2.5, 3.5}).value();
    const double p = p_value(ratio);
    EXPECT_GT(p, 0);
    EXPECT_NEAR(to_ratio(ratio, 1 - p).interval->high, 1, 1e-9);
    // t = 4.302653 at two degrees of freedom.
    const LogRatio textbook{
        .value = -4.302653, .variance = 1, .degrees_of_freedom = 2, .why_none = std::nullopt};
    EXPECT_NEAR(p_value(textbook), 0.05, 1e-7);
}

TEST(PValue, OfAnIdentityIsOne) {
    const Values values = {1.0, 1.5, 1.25};
    EXPECT_EQ(p_value(paired_log_ratio(values, values).value()), 1);
}

}  // namespace
}  // namespace misbench
