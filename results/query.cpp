#include "results/query.h"

#include "renderer/base/error.h"
#include "results/schema.h"
#include "results/sqlite.h"
#include "results/store.h"

namespace misbench {
namespace {

std::string hexadecimal(std::span<const std::byte> bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::byte byte : bytes) {
        text += kDigits[std::to_integer<std::size_t>(byte >> 4)];
        text += kDigits[std::to_integer<std::size_t>(byte & std::byte{15})];
    }
    return text;
}

QueryValue value_of(const Statement& statement, int column) {
    switch (statement.kind(column)) {
        case Statement::Kind::Null:
            return nullptr;
        case Statement::Kind::Integer:
            return statement.integer(column);
        case Statement::Kind::Real:
            return statement.real(column);
        case Statement::Kind::Text:
            return statement.text(column);
        case Statement::Kind::Blob:
            break;
    }
    return hexadecimal(statement.blob(column));
}

std::unique_ptr<Database> open_to_ask(const std::filesystem::path& store) {
    // The checks of a store, and their messages.
    Store(store, Store::Access::ReadOnly);
    return open_database(store / "results.sqlite", Database::Access::ReadOnly);
}

}  // namespace

Query::Query(const std::filesystem::path& store, std::string_view sql)
    : database_(open_to_ask(store)),
      statement_(std::make_unique<Statement>(database_->prepare_query(sql))) {
    for (int c = 0; c < statement_->n_columns(); ++c) {
        columns_.push_back(statement_->column_name(c));
    }
}

Query::~Query() = default;

bool Query::next(std::vector<QueryValue>& row) {
    if (is_at_end_) return false;  // where SQLite would begin again
    try {
        is_at_end_ = !statement_->step();
    } catch (const Error& e) {
        // What fails for what it asks, such as a sum that overflows.
        if (e.code() != Errc::Internal) throw;
        throw Error(Errc::InvalidArgument, std::string("query: ") + e.what());
    }
    if (is_at_end_) return false;
    row.clear();
    for (int c = 0; c < statement_->n_columns(); ++c) row.push_back(value_of(*statement_, c));
    return true;
}

std::string documented_tables(const std::filesystem::path& store) {
    const auto database = open_to_ask(store);
    Statement select = database->prepare(
        "SELECT sql FROM sqlite_schema WHERE type IN ('view', 'table') "
        "AND name NOT LIKE 'rollup%' AND name NOT LIKE 'sqlite%' AND name <> 'meta' "
        "ORDER BY type = 'table', name");
    std::string text;
    while (select.step()) text += select.text(0) + ";\n\n";
    if (!text.empty()) text.pop_back();
    return text;
}

}  // namespace misbench
