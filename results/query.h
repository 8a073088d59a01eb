// A question to a store in SQL, by anybody. It can change nothing: the database is opened for
// reading, and the connection refuses all statements that do not read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace misbench {

class Database;
class Statement;

// NULL, a number, a text; blobs are texts of hexadecimal digits.
using QueryValue = std::variant<std::nullptr_t, std::int64_t, double, std::string>;

class Query {
 public:
    // Throws NotFound without a store, InvalidArgument for what is not one statement that reads.
    Query(const std::filesystem::path& store, std::string_view sql);
    ~Query();
    Query(const Query&) = delete;
    Query& operator=(const Query&) = delete;

    const std::vector<std::string>& columns() const { return columns_; }
    // The next row into `row`; false at the end.
    bool next(std::vector<QueryValue>& row);

 private:
    std::unique_ptr<Database> database_;
    std::unique_ptr<Statement> statement_;
    std::vector<std::string> columns_;
    bool is_at_end_ = false;
};

// The statements that made what is there to ask, with what they say about it.
std::string documented_tables(const std::filesystem::path& store);

}  // namespace misbench
