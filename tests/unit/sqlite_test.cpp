#include "results/sqlite.h"

#include <gtest/gtest.h>

#include <limits>

#include "renderer/base/error.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

class SqliteTest : public testing::Test {
 protected:
    SqliteTest() : database_(temporary_.path() / "a?b#c%20d.sqlite", Database::Access::ReadWrite) {
        database_.execute("CREATE TABLE numbers (name TEXT NOT NULL, value REAL) STRICT");
    }
    void insert(std::string_view name, double value) const {
        database_.prepare("INSERT INTO numbers VALUES (?1, ?2)").bind(name, value).run();
    }
    std::int64_t count() const { return database_.integer("SELECT count(*) FROM numbers"); }

    const TemporaryFolder temporary_;
    const Database database_;
};

TEST_F(SqliteTest, RefusesANumberThatIsNotFinite) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(insert("bad", bad), Error);
    }
    EXPECT_EQ(count(), 0);
}

TEST_F(SqliteTest, TransactionThatIsNotCommittedChangesNothing) {
    try {
        Transaction transaction(database_);
        insert("one", 1);
        throw std::runtime_error("in between");
    } catch (const std::runtime_error&) {
    }
    EXPECT_EQ(count(), 0);
    Transaction transaction(database_);
    insert("two", 2);
    transaction.commit();
    EXPECT_EQ(count(), 1);
}

TEST_F(SqliteTest, EmptyTextIsNotNull) {
    EXPECT_NO_THROW(insert(std::string_view(), 1));
    EXPECT_NO_THROW(insert("", 1));
    EXPECT_EQ(count(), 2);
}

TEST_F(SqliteTest, FileHasTheNameThatWasAskedFor) {
    EXPECT_TRUE(std::filesystem::exists(temporary_.path() / "a?b#c%20d.sqlite"));
    const Database again(temporary_.path() / "a?b#c%20d.sqlite", Database::Access::ReadOnly);
    EXPECT_EQ(again.integer("SELECT count(*) FROM numbers"), 0);
}

TEST_F(SqliteTest, ReaderCannotWrite) {
    const Database reader(temporary_.path() / "a?b#c%20d.sqlite", Database::Access::ReadOnly);
    try {
        reader.execute("DELETE FROM numbers");
        ADD_FAILURE() << "written";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::FailedPrecondition) << e.what();
    }
}

}  // namespace
}  // namespace misbench
