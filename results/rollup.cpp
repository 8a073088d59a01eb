#include "results/rollup.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "renderer/base/check.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/log.h"
#include "results/measure.h"
#include "results/schema.h"

namespace misbench {
namespace {

static_assert(std::endian::native == std::endian::little, "rollups hold numbers as they are here");

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& numbers) {
    return std::as_bytes(std::span(numbers));
}

template <class T>
std::vector<T> numbers_of(std::span<const std::byte> bytes) {
    MISBENCH_CHECK(bytes.size() % sizeof(T) == 0);
    std::vector<T> numbers(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
}

// Rollups know nothing of what is measured in memory.
bool is_rolled_up(const Database& database, const std::string& experiment) {
    if (measures_in_memory(database)) return false;
    return database.prepare("SELECT 1 FROM experiments WHERE name = ?1 AND rolled_up = 1")
        .bind(experiment)
        .step();
}

char state_of(bool has_run, bool is_valid, std::string_view task_state) {
    const SeedState state = has_run ? (is_valid ? SeedState::Valid : SeedState::Invalid)
                            : task_state == "failed" ? SeedState::Failed
                                                     : SeedState::Unfinished;
    return static_cast<char>(state);
}

// Where a cell of the plan is among the seeds.
struct Place {
    std::size_t cell = 0;
    std::size_t seed = 0;
};
using Places = std::unordered_map<std::int64_t, Place>;  // by the position in the plan

Places read_runs(const Database& database, const std::string& experiment,
                 std::vector<CellSeeds>& cells) {
    Places places;
    std::map<std::tuple<std::string, std::string, std::string>, std::size_t> index;
    Statement select = database.prepare(R"sql(
        SELECT c.position, c.scene, c.method, c.budget, c.seed, t.state, r.id IS NOT NULL, r.valid,
               r.passes, r.wall_seconds, r.cpu_seconds, r.rays,
               json_extract(t.task, '$.parameters')
        FROM cells c JOIN tasks t ON t.id = c.task LEFT JOIN runs r ON r.id = c.task
        WHERE c.experiment = ?1 AND c.role = 'test' ORDER BY c.position)sql");
    select.bind(experiment);
    while (select.step()) {
        const auto [found, is_new] =
            index.try_emplace({select.text(1), select.text(2), select.text(3)}, cells.size());
        if (is_new) {
            CellSeeds& cell = cells.emplace_back();
            std::tie(cell.scene, cell.method, cell.budget) = found->first;
            cell.parameters = select.text(12);
        }
        CellSeeds& cell = cells[found->second];
        places[select.integer(0)] = {found->second, cell.seeds.size()};
        cell.seeds.push_back(select.integer(4));
        cell.states += state_of(select.integer(6) == 1, select.integer(7) == 1, select.text(5));
        cell.passes.push_back(select.real(8));
        cell.wall_seconds.push_back(select.real(9));
        cell.cpu_seconds.push_back(select.real(10));
        cell.rays.push_back(select.real(11));
        cell.reference_shares.push_back(kNone);
    }
    return places;
}

void read_values(const Database& database, const std::string& experiment, const Places& places,
                 std::vector<CellSeeds>& cells) {
    Statement select = database.prepare(R"sql(
        SELECT c.position, m.metric, m.value
        FROM cells c JOIN measurements m ON m.run = c.task AND m.snapshot = 0 AND m.reference_a = c.reference_a
                                        AND m.reference_b = c.reference_b
        WHERE c.experiment = ?1 AND c.role = 'test')sql");
    select.bind(experiment);
    while (select.step()) {
        const Place place = places.at(select.integer(0));
        CellSeeds& cell = cells[place.cell];
        std::vector<double>& values = cell.values[select.text(1)];
        values.resize(cell.seeds.size(), kNone);
        values[place.seed] = select.real(2);
    }
}

void read_reference_shares(const Database& database, const std::string& experiment,
                           const Places& places, std::vector<CellSeeds>& cells) {
    Statement select = database.prepare(R"sql(
        SELECT c.position, n.share
        FROM cells c JOIN reference_noise n ON n.run = c.task AND n.reference_a = c.reference_a
                                           AND n.reference_b = c.reference_b
        WHERE c.experiment = ?1 AND c.role = 'test')sql");
    select.bind(experiment);
    while (select.step()) {
        const Place place = places.at(select.integer(0));
        cells[place.cell].reference_shares[place.seed] = select.real(1);
    }
}

std::vector<Origin> read_origins(Statement& select, const std::string& experiment) {
    std::vector<Origin> origins;
    select.bind(experiment);
    while (select.step()) {
        origins.push_back({.provenance = {.build_id = select.text(0),
                                          .compiler = select.text(1),
                                          .flags = select.text(2),
                                          .cpu_model = select.text(3),
                                          .isa = select.text(4),
                                          .host = select.text(5)},
                           .threads = static_cast<int>(select.integer(6)),
                           .n_runs = static_cast<int>(select.integer(7))});
    }
    return origins;
}

std::vector<Origin> recompute_origins(const Database& database, const std::string& experiment) {
    Statement select = database.prepare(R"sql(
        SELECT r.build_id, r.compiler, r.flags, r.cpu_model, r.isa, r.host, r.threads, count(*)
        FROM cells c JOIN runs r ON r.id = c.task
        WHERE c.experiment = ?1 AND c.role = 'test'
        GROUP BY 1, 2, 3, 4, 5, 6, 7 ORDER BY min(c.position))sql");
    return read_origins(select, experiment);
}

void write_rollup(const Database& database, const std::string& experiment) {
    const std::vector<CellSeeds> cells = recompute_cells(database, experiment);
    Statement insert_cell = database.prepare(
        "INSERT INTO rollup_cells VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, "
        "?13)");
    Statement insert_values = database.prepare("INSERT INTO rollup_values VALUES (?1, ?2, ?3, ?4)");
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const CellSeeds& cell = cells[i];
        insert_cell
            .bind(experiment, i, cell.scene, cell.method, cell.budget, cell.parameters, cell.states,
                  bytes_of(cell.seeds), bytes_of(cell.passes), bytes_of(cell.wall_seconds),
                  bytes_of(cell.cpu_seconds), bytes_of(cell.rays), bytes_of(cell.reference_shares))
            .run();
        for (const auto& [metric, values] : cell.values) {
            insert_values.bind(experiment, metric, i, bytes_of(values)).run();
        }
    }
    Statement insert_origin = database.prepare(
        "INSERT INTO rollup_origins VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)");
    int position = 0;
    for (const auto& [from, threads, n_runs] : recompute_origins(database, experiment)) {
        insert_origin
            .bind(experiment, position++, from.build_id, from.compiler, from.flags, from.cpu_model,
                  from.isa, from.host, threads, n_runs)
            .run();
    }
    database.prepare("UPDATE experiments SET rolled_up = 1 WHERE name = ?1").bind(experiment).run();
}

std::vector<CellSeeds> read_rollup(const Database& database, const std::string& experiment,
                                   std::span<const std::string> metrics) {
    std::vector<CellSeeds> cells;
    Statement select = database.prepare(R"sql(
        SELECT scene, method, budget, parameters, states, seeds, passes, wall_seconds, cpu_seconds,
               rays, reference_shares FROM rollup_cells WHERE experiment = ?1 ORDER BY position)sql");
    select.bind(experiment);
    while (select.step()) {
        cells.push_back({.scene = select.text(0),
                         .method = select.text(1),
                         .budget = select.text(2),
                         .parameters = select.text(3),
                         .states = select.text(4),
                         .seeds = numbers_of<std::int64_t>(select.blob(5)),
                         .passes = numbers_of<double>(select.blob(6)),
                         .wall_seconds = numbers_of<double>(select.blob(7)),
                         .cpu_seconds = numbers_of<double>(select.blob(8)),
                         .rays = numbers_of<double>(select.blob(9)),
                         .reference_shares = numbers_of<double>(select.blob(10)),
                         .values = {}});
    }
    Statement values = database.prepare(
        "SELECT position, numbers FROM rollup_values WHERE experiment = ?1 AND metric = ?2");
    for (const std::string& metric : metrics) {
        values.bind(experiment, metric);
        while (values.step()) {
            cells[static_cast<std::size_t>(values.integer(0))].values[metric] =
                numbers_of<double>(values.blob(1));
        }
    }
    return cells;
}

}  // namespace

std::vector<CellSeeds> recompute_cells(const Database& database, const std::string& experiment) {
    std::vector<CellSeeds> cells;
    const Places places = read_runs(database, experiment, cells);
    read_values(database, experiment, places, cells);
    read_reference_shares(database, experiment, places, cells);
    return cells;
}

void roll_up(const Database& database) {
    std::vector<std::string> names;
    Statement select = database.prepare("SELECT name FROM experiments WHERE rolled_up = 0");
    while (select.step()) names.push_back(select.text(0));
    for (const std::string& name : names) {
        Transaction transaction(database);
        write_rollup(database, name);
        transaction.commit();
    }
}

void roll_up_if_left_without(const std::filesystem::path& store) {
    const auto path = store / "results.sqlite";
    if (!std::filesystem::exists(path)) return;
    const auto n_cells = open_database(path, Database::Access::ReadOnly)
                             ->integer(
                                 "SELECT count(*) FROM cells JOIN experiments ON name = experiment "
                                 "WHERE rolled_up = 0");
    if (n_cells < kCellsWorthARollup) return;
    try {
        const FileLock lock(store / "lock");
        roll_up(*open_database(path, Database::Access::ReadWrite));
    } catch (const Error& e) {
        // Rows say the same, if slowly.
        spdlog::debug("not rolled up: {}", e.what());
    }
}

std::vector<CellSeeds> select_cells(const Database& database, const std::string& experiment,
                                    std::span<const std::string> metrics) {
    // One view of the database, whatever a writer does meanwhile.
    const Transaction reading(database, Transaction::Kind::Read);
    if (is_rolled_up(database, experiment)) return read_rollup(database, experiment, metrics);
    std::vector<CellSeeds> cells = recompute_cells(database, experiment);
    for (CellSeeds& cell : cells) {
        std::erase_if(cell.values, [&metrics](const auto& entry) {
            return std::ranges::find(metrics, entry.first) == metrics.end();
        });
    }
    return cells;
}

void insert_comparisons(const Database& database, const std::vector<StoredComparison>& rows) {
    Transaction transaction(database);
    Statement erase = database.prepare(
        "DELETE FROM comparisons WHERE experiment = ?1 AND metric = ?2 AND baseline = ?3");
    for (const StoredComparison& row : rows) {
        erase.bind(row.experiment, row.metric, row.baseline).run();
    }
    Statement insert = database.prepare(
        "INSERT INTO comparisons VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)");
    for (const StoredComparison& row : rows) {
        insert
            .bind(row.experiment, row.metric, row.baseline, row.scene, row.method, row.budget,
                  row.ratio, row.low, row.high, row.p, row.adjusted_p)
            .run();
    }
    transaction.commit();
}

std::vector<Origin> select_origins(const Database& database, const std::string& experiment) {
    const Transaction reading(database, Transaction::Kind::Read);
    if (!is_rolled_up(database, experiment)) return recompute_origins(database, experiment);
    Statement select = database.prepare(R"sql(
        SELECT build_id, compiler, flags, cpu_model, isa, host, threads, n_runs
        FROM rollup_origins WHERE experiment = ?1 ORDER BY position)sql");
    return read_origins(select, experiment);
}

}  // namespace misbench
