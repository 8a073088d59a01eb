// The language of `misbench table --where`.
#include "experiments/analysis/filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "renderer/base/error.h"

namespace misbench {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::set<std::string> kFields{"scene", "method", "budget", "value", "max_depth", "nee"};

bool matches(const std::string& text) {
    const std::map<std::string, ParameterValue> seed{{"scene", std::string("Veach MIS")},
                                                     {"method", std::string("path-5")},
                                                     {"budget", std::string("30 s cpu")},
                                                     {"value", 0.05},
                                                     {"max_depth", std::int64_t{5}}};
    return Filter(text, kFields)
        .matches([&](const std::string& field) -> std::optional<ParameterValue> {
            const auto found = seed.find(field);
            if (found == seed.end()) return std::nullopt;
            return found->second;
        });
}

std::string error_of(const std::string& text) {
    try {
        Filter(text, kFields);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::InvalidArgument);
        return e.what();
    }
    return "";
}

TEST(Filter, ComparesTextsNumbersAndBudgets) {
    EXPECT_TRUE(matches("scene='Veach MIS'"));
    EXPECT_FALSE(matches("scene=veach"));
    EXPECT_TRUE(matches("scene~veach"));
    EXPECT_TRUE(matches("scene~v*mis"));
    EXPECT_TRUE(matches("method ~ path-?"));
    EXPECT_FALSE(matches("method~path?"));
    EXPECT_FALSE(matches("method~*a"));
    EXPECT_TRUE(matches("value<0.1 and value>=5e-2 and value<=0.05 and not value>0.05"));
    EXPECT_TRUE(matches("max_depth>=5"));
    EXPECT_FALSE(matches("max_depth<05"));
    EXPECT_TRUE(matches("max_depth=5.0"));
    for (const char* budget : {"30s", "'30 s'", "\"30 s cpu\"", "30scpu"}) {
        EXPECT_TRUE(matches(std::string("budget=") + budget)) << budget;
        EXPECT_FALSE(matches(std::string("budget!=") + budget)) << budget;
    }
    EXPECT_FALSE(matches("budget=3s"));
    EXPECT_FALSE(matches("budget=30swall"));
}

TEST(Filter, AndBindsMoreThanOrAndNotMost) {
    const std::string yes = "max_depth=5";
    const std::string no = "max_depth=6";
    EXPECT_TRUE(matches(yes + " or " + yes + " and " + no));
    EXPECT_FALSE(matches("(" + yes + " or " + yes + ") and " + no));
    EXPECT_TRUE(matches("not " + no + " and " + yes));
    EXPECT_FALSE(matches("not (" + no + " or " + yes + ")"));
    EXPECT_TRUE(matches("NOT not " + yes));
}

TEST(Filter, AFieldThatASeedLacksIsOnlyUnequal) {
    EXPECT_FALSE(matches("nee=true"));
    EXPECT_FALSE(matches("nee~t"));
    EXPECT_FALSE(matches("nee<1"));
    EXPECT_TRUE(matches("nee!=true"));
}

TEST(Filter, ErrorsNameTheColumnAndWhatIsKnown) {
    EXPECT_EQ(error_of("scen=x"),
              "filter, column 1: expected a field; known: budget max_depth method nee scene value, "
              "found 'scen=x'");
    EXPECT_EQ(error_of("scene"),
              "filter, column 6: expected one of = != ~ < <= > >=, found the end");
    EXPECT_EQ(error_of("scene= and"), "");  // a scene may be called "and"
    EXPECT_THAT(error_of("scene="), StartsWith("filter, column 7: expected a value"));
    EXPECT_THAT(error_of("(scene=x"), StartsWith("filter, column 9: expected ')'"));
    EXPECT_THAT(error_of("scene=x)"), HasSubstr("column 8: expected 'and', 'or' or the end"));
    EXPECT_THAT(error_of("scene='x"), HasSubstr("the end of a quotation"));
    EXPECT_THAT(error_of("budget<30s"), HasSubstr("has no order"));
    EXPECT_THAT(error_of(""), HasSubstr("expected a field"));
    EXPECT_THAT(error_of(std::string(5000, '(')), HasSubstr("fewer parentheses"));
    std::string nots;
    for (int i = 0; i < 5000; ++i) nots += "not ";
    EXPECT_THAT(error_of(nots), HasSubstr("fewer parentheses"));
}

TEST(Filter, AnyTextIsAFilterOrAnError) {
    constexpr std::array kPieces{"scene", "method", "=",    "!=",   "~",    "<=",  "(",
                                 ")",     " ",      "and",  " or ", "not ", "'x'", "\"",
                                 "5.0",   "*",      "\xc3", "30s",  "?",    "\n"};
    std::mt19937 random(3);
    int n_filters = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        std::string text;
        const int length = static_cast<int>(random() % 9);
        for (int i = 0; i < length; ++i) text += kPieces[random() % kPieces.size()];
        try {
            Filter(text, kFields).matches([](const std::string&) {
                return std::optional<ParameterValue>(std::string("x"));
            });
            ++n_filters;
        } catch (const Error& e) {
            ASSERT_EQ(e.code(), Errc::InvalidArgument) << text;
        }
    }
    EXPECT_GT(n_filters, 20);
}

}  // namespace
}  // namespace misbench
