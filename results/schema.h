// The tables of results.sqlite, its version, and the view that is made for people:
//
//   sqlite3 -readonly STORE/results.sqlite
//     "SELECT scene, method, seed, value FROM results WHERE metric = 'mse'"
#pragma once

#include <filesystem>
#include <memory>

#include "results/sqlite.h"

namespace misbench {

// Opens a store's database, with its tables made if it is new. Throws FailedPrecondition for
// another program's database and for another version of the schema.
std::unique_ptr<Database> open_database(const std::filesystem::path& path, Database::Access access);

}  // namespace misbench
