#include "results/sqlite.h"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "renderer/base/check.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

constexpr int kBusyTimeoutMs = 10'000;

Errc code_of(int sqlite_code) {
    switch (sqlite_code & 0xff) {
        case SQLITE_FULL:
        case SQLITE_IOERR:
        case SQLITE_CORRUPT:
        case SQLITE_NOTADB:
            return Errc::DataLoss;
        case SQLITE_READONLY:
        case SQLITE_CANTOPEN:
        case SQLITE_PERM:
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return Errc::FailedPrecondition;
        default:
            return Errc::Internal;
    }
}

[[noreturn]] void throw_error(sqlite3* database, const std::string& path, int code) {
    std::string what = database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(code);
    const int system = database != nullptr ? sqlite3_system_errno(database) : 0;
    const int primary = code & 0xff;
    if (system != 0 && (primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN)) {
        what += std::string(" (") + std::strerror(system) + ")";
    }
    if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB) {
        what += "; `misbench reindex` makes it anew from the runs";
    }
    throw Error(code_of(code), "database '" + path + "': " + what);
}

void check(sqlite3* database, int code) {
    if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE) return;
    const char* path = sqlite3_db_filename(database, "main");
    throw_error(database, path != nullptr ? path : "", code);
}

int allow_reading(void* /*context*/, int action, const char* first, const char* second,
                  const char* /*database*/, const char* /*trigger*/) {
    constexpr std::array<std::string_view, 6> kDescribing{
        "table_info", "table_xinfo", "table_list", "index_list", "index_info", "foreign_key_list"};
    switch (action) {
        case SQLITE_SELECT:
        case SQLITE_READ:
        case SQLITE_RECURSIVE:
            return SQLITE_OK;
        case SQLITE_FUNCTION:
            return second != nullptr && std::string_view(second) == "load_extension" ? SQLITE_DENY
                                                                                     : SQLITE_OK;
        case SQLITE_PRAGMA:
            return std::ranges::find(kDescribing, std::string_view(first)) != kDescribing.end()
                       ? SQLITE_OK
                       : SQLITE_DENY;
        default:
            return SQLITE_DENY;
    }
}

// The path as the path of a URI.
std::string escaped(const std::string& path) {
    std::string uri;
    for (const char c : path) {
        if (c == '%' || c == '?' || c == '#') {
            constexpr std::string_view kDigits = "0123456789abcdef";
            uri += {'%', kDigits[static_cast<unsigned char>(c) >> 4],
                    kDigits[static_cast<unsigned char>(c) & 15]};
        } else {
            uri += c;
        }
    }
    return uri;
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(sqlite3* database, std::string_view sql) {
    sqlite3_stmt* statement = nullptr;
    misbench::check(database, sqlite3_prepare_v2(database, sql.data(), static_cast<int>(sql.size()),
                                                 &statement, nullptr));
    handle_.reset(statement);
}

Statement::Statement(sqlite3_stmt* prepared) : handle_(prepared) {}

void Statement::check(int code) const { misbench::check(sqlite3_db_handle(handle_.get()), code); }

void Statement::reset() { sqlite3_reset(handle_.get()); }

bool Statement::step() {
    const int code = sqlite3_step(handle_.get());
    check(code);
    return code == SQLITE_ROW;
}

void Statement::run() {
    while (step()) {
    }
}

void Statement::bind_one(int index, double value) {
    if (!std::isfinite(value)) {
        throw Error(Errc::Internal, "store a number: " + std::to_string(value) + " is not finite");
    }
    check(sqlite3_bind_double(handle_.get(), index, value));
}

void Statement::bind_one(int index, std::int64_t value) {
    check(sqlite3_bind_int64(handle_.get(), index, value));
}

void Statement::bind_one(int index, std::string_view value) {
    // A null pointer would be stored as NULL.
    const char* bytes = value.empty() ? "" : value.data();
    check(sqlite3_bind_text64(handle_.get(), index, bytes, value.size(), SQLITE_TRANSIENT,
                              SQLITE_UTF8));
}

void Statement::bind_one(int index, std::span<const std::byte> value) {
    const void* bytes = value.empty() ? "" : static_cast<const void*>(value.data());
    check(sqlite3_bind_blob64(handle_.get(), index, bytes, value.size(), SQLITE_TRANSIENT));
}

void Statement::bind_one(int index, std::nullptr_t) {
    check(sqlite3_bind_null(handle_.get(), index));
}

std::int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(handle_.get(), column);
}

double Statement::real(int column) const { return sqlite3_column_double(handle_.get(), column); }

std::string Statement::text(int column) const {
    const unsigned char* bytes = sqlite3_column_text(handle_.get(), column);
    if (bytes == nullptr) return {};
    return {reinterpret_cast<const char*>(bytes),
            static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

std::span<const std::byte> Statement::blob(int column) const {
    const void* bytes = sqlite3_column_blob(handle_.get(), column);
    return {static_cast<const std::byte*>(bytes),
            static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

Statement::Kind Statement::kind(int column) const {
    switch (sqlite3_column_type(handle_.get(), column)) {
        case SQLITE_INTEGER:
            return Kind::Integer;
        case SQLITE_FLOAT:
            return Kind::Real;
        case SQLITE_TEXT:
            return Kind::Text;
        case SQLITE_BLOB:
            return Kind::Blob;
        default:
            return Kind::Null;
    }
}

int Statement::n_columns() const { return sqlite3_column_count(handle_.get()); }

std::string Statement::column_name(int column) const {
    return sqlite3_column_name(handle_.get(), column);
}

void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

Database::Database(const std::filesystem::path& path, Access access) {
    const bool read_only = access == Access::ReadOnly;
    const std::string uri =
        "file:" + escaped(path.string()) + (read_only ? "?mode=ro&readonly_shm=1" : "?mode=rwc");
    sqlite3* database = nullptr;
    const int code = sqlite3_open_v2(
        uri.c_str(), &database,
        SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX |
            (read_only ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE),
        nullptr);
    handle_.reset(database);
    if (code != SQLITE_OK) throw_error(database, path.string(), code);
    sqlite3_extended_result_codes(database, 1);
    sqlite3_busy_timeout(database, kBusyTimeoutMs);
    execute("PRAGMA foreign_keys = ON");
    // SQLite falls back to reading where it may not write.
    if (!read_only && sqlite3_db_readonly(database, "main") == 1) {
        throw_error(nullptr, path.string(), SQLITE_READONLY);
    }
}

Database::~Database() {
    if (!writing_) return;
    // Fails, without harm, while a reader is connected: the next writer does it.
    sqlite3_busy_timeout(handle_.get(), 0);
    sqlite3_exec(handle_.get(), "PRAGMA journal_mode = DELETE", nullptr, nullptr, nullptr);
}

void Database::begin_writing() {
    execute("PRAGMA journal_mode = WAL");
    // What a commit returns from is on the disk: an epoch that is handed out stays handed out.
    execute("PRAGMA synchronous = FULL");
    writing_ = true;
}

Statement Database::prepare(std::string_view sql) const { return {handle_.get(), sql}; }

Statement Database::prepare_query(std::string_view sql) const {
    sqlite3_set_authorizer(handle_.get(), allow_reading, nullptr);
    sqlite3_stmt* raw = nullptr;
    const char* rest = nullptr;
    int code =
        sqlite3_prepare_v2(handle_.get(), sql.data(), static_cast<int>(sql.size()), &raw, &rest);
    Statement statement(raw);
    if (code == SQLITE_OK && raw == nullptr) {
        throw Error(Errc::InvalidArgument, "query: it is empty");
    }
    // VACUUM asks no authorizer, and writes another file where it has an INTO.
    if (code == SQLITE_OK && (sqlite3_stmt_readonly(raw) == 0 || sqlite3_column_count(raw) == 0)) {
        throw Error(Errc::InvalidArgument, "query: not authorized; a query may only read");
    }
    if (code == SQLITE_OK) {
        // Nothing but spaces and comments makes no statement.
        sqlite3_stmt* second = nullptr;
        const auto left = static_cast<int>(sql.data() + sql.size() - rest);
        code = sqlite3_prepare_v2(handle_.get(), rest, left, &second, nullptr);
        const Statement ends_with_it(second);
        if (code == SQLITE_OK && second != nullptr) {
            throw Error(Errc::InvalidArgument, "query: it has a second statement");
        }
    }
    if (code != SQLITE_OK) {
        throw Error(Errc::InvalidArgument,
                    std::string("query: ") + sqlite3_errmsg(handle_.get()) +
                        ((code & 0xff) == SQLITE_AUTH ? "; a query may only read" : ""));
    }
    return statement;
}

void Database::execute(const std::string& sql) const {
    check(handle_.get(), sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr));
}

bool Database::has_moved() const {
    int moved = 0;
    check(handle_.get(),
          sqlite3_file_control(handle_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved));
    return moved != 0;
}

std::int64_t Database::integer(std::string_view sql) const {
    Statement statement = prepare(sql);
    MISBENCH_CHECK(statement.step());
    return statement.integer(0);
}

Transaction::Transaction(const Database& database, Kind kind) : database_(database) {
    database_.execute(kind == Kind::Read ? "BEGIN" : "BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
    if (!open_) return;
    try {
        database_.execute("ROLLBACK");
    } catch (const Error&) {
        // SQLite rolled back by itself when the disk was full.
    }
}

void Transaction::commit() {
    database_.execute("COMMIT");
    open_ = false;
}

}  // namespace misbench
