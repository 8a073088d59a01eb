// From files to rows.
#pragma once

#include <filesystem>
#include <string>

#include "results/sqlite.h"
#include "results/store.h"

namespace misbench {

// Indexes every run directory and experiment file that has no row, or another one.
Reindexed index_files(const Database& database, const std::filesystem::path& store);

// Moves a file or folder of the store to STORE/damaged/. Returns its new path.
std::filesystem::path set_aside(const std::filesystem::path& store,
                                const std::filesystem::path& damaged);

// The folders of a store, made where they are missing. Throws FailedPrecondition for a folder that
// holds something else.
void make_folders(const std::filesystem::path& store);

}  // namespace misbench
