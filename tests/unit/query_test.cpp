// Anybody's SQL reads a store and changes nothing.
#include "results/query.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/base/error.h"
#include "results/schema.h"
#include "results/sqlite.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class QueryTest : public testing::Test {
 protected:
    QueryTest() : path_(temporary_.path() / "store") {
        Store store(path_, Store::Access::ReadWrite);
        const Plan plan = made_up_plan("first", 3);
        store.put_experiment(plan);
        commit_all(store, plan);
        store.measure(plan);
    }

    TemporaryFolder temporary_;
    std::filesystem::path path_;
};

TEST_F(QueryTest, ReadsValuesOfEveryKind) {
    Query query(path_,
                "SELECT count(*) AS n, 0.5, NULL, 'x', x'00ff' FROM results -- the end ;\n;");
    EXPECT_THAT(query.columns(), ElementsAre("n", "0.5", "NULL", "'x'", "x'00ff'"));
    std::vector<QueryValue> row;
    ASSERT_TRUE(query.next(row));
    EXPECT_THAT(row, ElementsAre(QueryValue(std::int64_t{12}), QueryValue(0.5), QueryValue(nullptr),
                                 QueryValue(std::string("x")), QueryValue(std::string("00ff"))));
    EXPECT_FALSE(query.next(row));
    EXPECT_FALSE(query.next(row));
}

TEST_F(QueryTest, RefusesWhatDoesNotRead) {
    const auto before = hashes_below(temporary_.path());
    const std::string other = (temporary_.path() / "other.sqlite").string();
    for (const std::string& sql : {std::string("DELETE FROM runs"),
                                   std::string("UPDATE runs SET passes = 1"),
                                   std::string("INSERT INTO meta VALUES (2, 2)"),
                                   std::string("DROP VIEW results"),
                                   std::string("CREATE TABLE mine (x)"),
                                   std::string("CREATE TEMP TABLE mine (x)"),
                                   "ATTACH '" + other + "' AS other",
                                   "VACUUM INTO '" + other + "'",
                                   std::string("VACUUM"),
                                   std::string("PRAGMA user_version = 7"),
                                   std::string("PRAGMA journal_mode = WAL"),
                                   std::string("PRAGMA writable_schema = 1"),
                                   std::string("PRAGMA query_only = 0"),
                                   std::string("BEGIN"),
                                   std::string("REINDEX"),
                                   std::string("ANALYZE"),
                                   std::string("SELECT load_extension('x')"),
                                   std::string("WITH x AS (SELECT 1) DELETE FROM runs"),
                                   std::string("SELECT 1; DELETE FROM runs"),
                                   std::string("SELECT nothing"),
                                   std::string("SELEC 1"),
                                   std::string(""),
                                   std::string("-- nothing")}) {
        try {
            Query query(path_, sql);
            ADD_FAILURE() << "accepted: " << sql;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), Errc::InvalidArgument) << sql;
            EXPECT_THAT(e.what(), testing::StartsWith("query: ")) << sql;
        }
    }
    EXPECT_EQ(hashes_below(temporary_.path()), before);
}

TEST_F(QueryTest, DescribesTheTablesThatThereAre) {
    EXPECT_NO_THROW(Query(path_, "PRAGMA table_info(runs)"));
    EXPECT_NO_THROW(Query(path_, "SELECT name FROM sqlite_schema"));
    const std::string text = documented_tables(path_);
    for (const char* name : {"VIEW results", "TABLE comparisons", "TABLE runs", "TABLE cells"}) {
        EXPECT_THAT(text, HasSubstr(std::string("CREATE ") + name));
    }
    EXPECT_THAT(text, testing::Not(HasSubstr("rollup_cells")));
}

// Every query of the documentation.
TEST_F(QueryTest, AnswersTheQueriesOfTheDocumentation) {
    for (const char* sql :
         {"SELECT scene, method, count(*) AS n, avg(value) AS mean FROM results "
          "WHERE experiment = 'first' AND metric = 'mse' GROUP BY 1, 2 ORDER BY 1, 4",
          "SELECT scene, method, ratio, low, high, adjusted_p FROM comparisons "
          "WHERE adjusted_p <= 0.05 ORDER BY ratio",
          "SELECT worker, build_id, count(*) AS runs, sum(cpu_seconds) / 3600 AS hours "
          "FROM runs GROUP BY 1, 2"}) {
        Query query(path_, sql);
        std::vector<QueryValue> row;
        while (query.next(row)) EXPECT_EQ(row.size(), query.columns().size());
    }
}

}  // namespace
}  // namespace misbench
