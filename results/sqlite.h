// SQLite by RAII, as little of it as the store needs. One connection per thread; errors are Error
// with the database's path and SQLite's own words.
//
// A store that nobody writes is one file in rollback mode: it can be read from a read-only folder,
// and a reader holds nothing but POSIX locks. A writer switches to a write-ahead log for as long as
// it is open, so that readers never wait for it nor it for them. Readers map the log's index
// read-only and build one of their own in memory after a crash; either way they change no byte.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace misbench {

class Statement {
 public:
    Statement(sqlite3* database, std::string_view sql);
    explicit Statement(sqlite3_stmt* prepared);

    // Starts over with these values for ?1, ?2, … A double that is not finite is refused: SQLite
    // would keep a NaN as NULL.
    Statement& bind(const auto&... values) {
        reset();
        int index = 0;
        (bind_one(++index, values), ...);
        return *this;
    }
    // True while there is a row. A change counts from the call that returns false.
    bool step();
    // For a statement that has no rows to read, or whose rows do not matter.
    void run();

    // Columns of the current row, from 0.
    std::int64_t integer(int column) const;
    double real(int column) const;
    std::string text(int column) const;
    enum class Kind { Null, Integer, Real, Text, Blob };
    Kind kind(int column) const;
    int n_columns() const;
    std::string column_name(int column) const;
    // Valid until the next step.
    std::span<const std::byte> blob(int column) const;

 private:
    struct Finalize {
        void operator()(sqlite3_stmt* statement) const;
    };
    void reset();
    void bind_one(int index, double value);
    void bind_one(int index, std::int64_t value);
    void bind_one(int index, std::string_view value);
    void bind_one(int index, std::span<const std::byte> value);
    void bind_one(int index, std::nullptr_t);
    void bind_one(int index, const std::optional<double>& value) {
        value ? bind_one(index, *value) : bind_one(index, nullptr);
    }
    void bind_one(int index, std::integral auto value) {
        bind_one(index, static_cast<std::int64_t>(value));
    }
    void check(int code) const;

    std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

class Database {
 public:
    enum class Access { ReadOnly, ReadWrite };

    // ReadWrite creates an empty database where there is none.
    Database(const std::filesystem::path& path, Access access);
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    // Switches to the write-ahead log until this connection ends.
    void begin_writing();

    Statement prepare(std::string_view sql) const;
    // Of a query by anybody: exactly one statement that reads. From the first call on, this
    // connection refuses whatever else: changes, ATTACH, PRAGMAs but those that describe tables.
    // Throws InvalidArgument.
    Statement prepare_query(std::string_view sql) const;
    // One or several statements whose rows do not matter.
    void execute(const std::string& sql) const;
    // The first column of the first row. REQUIRES: there is one.
    std::int64_t integer(std::string_view sql) const;
    // Its file is not where it was opened, or another one is.
    bool has_moved() const;

 private:
    struct Close {
        void operator()(sqlite3* database) const;
    };
    std::unique_ptr<sqlite3, Close> handle_;
    bool writing_ = false;
};

// Rolls back unless committed.
class Transaction {
 public:
    // Reading needs no commit: it sees one state of the database until it ends.
    enum class Kind { Read, Write };
    explicit Transaction(const Database& database, Kind kind = Kind::Write);
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void commit();

 private:
    const Database& database_;
    bool open_ = true;
};

}  // namespace misbench
