// Rollups: the seeds of an experiment's cells side by side, so that a table of a million
// measurements is read in a few hundred rows. They are copies. The triggers in schema.cpp delete
// them with the first change of what they were made from, whoever makes it; so one that is there
// is right, and without it the same values come from the rows themselves.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "results/cell_seeds.h"
#include "results/sqlite.h"
#include "results/store.h"

namespace misbench {

// Makes the rollups that are not there.
void roll_up(const Database& database);

// Whoever measures a store rolls it up. One that was left before that, by a crash or by hand, is
// rolled up by the first who asks: if it is large enough for that to matter, and nobody's who
// writes. Throws like opening the database.
inline constexpr int kCellsWorthARollup = 10'000;
void roll_up_if_left_without(const std::filesystem::path& store);

// In the order in which the plan first names the cells. `values` holds the metrics asked for.
std::vector<CellSeeds> select_cells(const Database& database, const std::string& experiment,
                                    std::span<const std::string> metrics);
// The same from the rows, whether or not there is a rollup, and with every metric that is stored.
std::vector<CellSeeds> recompute_cells(const Database& database, const std::string& experiment);

// See Store::put_comparisons.
void insert_comparisons(const Database& database, const std::vector<StoredComparison>& rows);

// Of the tested runs, by the first of each.
std::vector<Origin> select_origins(const Database& database, const std::string& experiment);

}  // namespace misbench
