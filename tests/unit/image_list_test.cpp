// What `misbench import` makes of file names and lists.
#include <gmock/gmock.h>

#include "experiments/cli/image_list.h"
#include "tests/support/store_fixture.h"

namespace misbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::vector<std::string> kKnown = {"scene", "method", "seed", "seconds"};

TEST(PathPattern, ReadsFieldsFromPaths) {
    const PathPattern pattern("{scene}/{method}-seed{seed}.exr", kKnown);
    EXPECT_EQ(pattern.match("Box/vcm-seed12.exr"),
              (Fields{{"scene", "Box"}, {"method", "vcm"}, {"seed", "12"}}));
    EXPECT_EQ(pattern.match("Box/LightTop/my-vcm-seed1.exr"),
              (Fields{{"scene", "Box/LightTop"}, {"method", "my-vcm"}, {"seed", "1"}}));
    EXPECT_EQ(pattern.match("Box/vcm-seed.exr"), std::nullopt);
    EXPECT_EQ(pattern.match("Box/vcm-seedx.exr"), std::nullopt);
    EXPECT_EQ(pattern.match("Box/vcm-seed1.exr.bak"), std::nullopt);
    EXPECT_EQ(PathPattern("{method}_{seconds}s_*.exr", kKnown).match("pt_12.5s_.exr"),
              (Fields{{"method", "pt"}, {"seconds", "12.5"}}));
}

TEST(PathPattern, RefusesWhatItDoesNotKnowAndWhatIsAmbiguous) {
    EXPECT_THAT(message_of(Errc::InvalidArgument, [] { PathPattern("{sed}", kKnown); }),
                HasSubstr("unknown field 'sed' (did you mean 'seed'?)"));
    message_of(Errc::InvalidArgument, [] { PathPattern("{seed", kKnown); });
    message_of(Errc::InvalidArgument, [] { PathPattern("{seed}{seed}", kKnown); });
    const PathPattern pattern("{scene}-{method}.exr", kKnown);
    EXPECT_THAT(
        message_of(Errc::InvalidArgument, [&] { pattern.match("a-b-c.exr"); }),
        AllOf(HasSubstr("in two ways"), HasSubstr("method='b-c'"), HasSubstr("method='c'")));
}

TEST(ImageFields, GiveTheBudgetAndWhatItTook) {
    const auto image = [](const Fields& fields) { return image_of("a.exr", fields); };
    EXPECT_EQ(image({{"samples", "16"}}).budget, Budget(SampleBudget{16}));
    EXPECT_EQ(image({{"samples", "16"}}).passes, 16);
    EXPECT_EQ(image({{"seconds", "12.1"}}).budget, Budget(TimeBudget{12.1, BudgetClock::Cpu}));
    EXPECT_EQ(image({{"seconds", "12.1"}}).cpu_seconds, 12.1);
    EXPECT_EQ(image({{"seconds", "2"}, {"clock", "wall"}}).wall_seconds, 2);
    const ImageToImport timed =
        image({{"seconds", "12.1"}, {"clock", "wall"}, {"budget", "10 s wall"}, {"passes", "80"}});
    EXPECT_EQ(timed.budget, Budget(TimeBudget{10, BudgetClock::Wall}));
    EXPECT_EQ(timed.wall_seconds, 12.1);
    EXPECT_EQ(timed.passes, 80);
    EXPECT_EQ(image({{"samples", "16"}, {"seconds", "3"}}).budget, Budget(SampleBudget{16}));
    for (const Fields& wrong :
         {Fields{{"seed", "-1"}}, Fields{{"seed", "1x"}}, Fields{{"samples", "0"}},
          Fields{{"seconds", "nan"}}, Fields{{"seconds", "0"}}, Fields{{"budget", "10 s"}},
          Fields{{"budget", "10 s wall "}}, Fields{{"clock", "sun"}}}) {
        message_of(Errc::InvalidArgument, [&] { image(wrong); });
    }
}

TEST(ImageList, IsReadFromCsv) {
    const TemporaryFolder folder;
    const auto list = folder.write("list/images.csv",
                                   "path,scene,method,seed,budget,renderer\r\n"
                                   "a.exr,\"Box, the \"\"small\"\" one\",pt,3,16 spp,\n"
                                   "\"b,c.exr\",Box,,4,2 s cpu,Own 2\n\n");
    const auto images = images_of_list(list, {{"renderer", "Other"}, {"method", "given"}});
    ASSERT_THAT(images, SizeIs(2));
    EXPECT_EQ(images[0].file, list.parent_path() / "a.exr");
    EXPECT_EQ(images[0].scene, "Box, the \"small\" one");
    EXPECT_EQ(images[0].method, "pt");
    EXPECT_EQ(images[0].renderer, "Other");
    EXPECT_EQ(images[1].file, list.parent_path() / "b,c.exr");
    EXPECT_EQ(images[1].method, "given");
    EXPECT_EQ(images[1].seed, 4);
    EXPECT_EQ(images[1].renderer, "Own 2");
    for (const auto& [text, why] :
         std::map<std::string, std::string>{{"", "it is empty"},
                                            {"path,colour\n", "unknown column 'colour'"},
                                            {"scene\nBox\n", "no column 'path'"},
                                            {"path,scene\na.exr\n", "row 2 has 1 fields"},
                                            {"path\n\"a.exr\n", "a quote is not closed"}}) {
        const auto wrong = folder.write("wrong.csv", text);
        EXPECT_THAT(message_of(Errc::InvalidArgument, [&] { images_of_list(wrong, {}); }),
                    HasSubstr(why));
    }
}

TEST(ImageList, IsReadFromAFolder) {
    const TemporaryFolder folder;
    for (const char* name : {"Box/pt-2.exr", "Box/pt-1.exr", "Box/other.exr", "notes.txt"}) {
        folder.write(name, "");
    }
    std::vector<std::string> passed_over;
    const auto images =
        images_below(folder.path(), "{scene}/{method}-{seed}.exr", {{"samples", "4"}}, passed_over);
    ASSERT_THAT(images, SizeIs(2));
    EXPECT_EQ(images[0].seed, 1);
    EXPECT_EQ(images[0].passes, 4);
    EXPECT_THAT(passed_over, ElementsAre("Box/other.exr"));
    EXPECT_THAT(message_of(Errc::InvalidArgument,
                           [&] { images_below(folder.path(), "{scene}.pfm", {}, passed_over); }),
                HasSubstr("there is 'Box/other.exr'"));
    message_of(Errc::NotFound,
               [&] { images_below(folder.path() / "none", "{scene}.exr", {}, passed_over); });
}

TEST(Budgets, AreReadAsTheyArePrinted) {
    for (const Budget& budget :
         {Budget(SampleBudget{16}), Budget(TimeBudget{2, BudgetClock::Cpu}),
          Budget(TimeBudget{0.1, BudgetClock::Wall}), Budget(TimeBudget{1e6, BudgetClock::Wall})}) {
        EXPECT_EQ(budget_from_string(to_string(budget)), budget) << to_string(budget);
    }
    for (const char* wrong : {"", "16", "spp", " spp", "16  spp", "-1 spp", "1.5 spp", "inf s cpu",
                              "0 s cpu", "2 s", "2 s cpu wall"}) {
        message_of(Errc::InvalidArgument, [&] { budget_from_string(wrong); });
    }
}

}  // namespace
}  // namespace misbench
