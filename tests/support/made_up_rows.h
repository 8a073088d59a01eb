// The rows of a store without its files: as many as one likes, in seconds.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "results/schema.h"
#include "results/store.h"

namespace misbench {

struct MadeUpRows {
    int n_scenes = 20;
    int n_methods = 10;
    int n_seeds = 1000;
};

// An experiment "million" of this size at 16 spp, done, with five metrics a run. What it is
// measured with is not the renderer's business here: errors are lognormal-like, 3 % better from
// method to method.
inline void make_rows(const std::filesystem::path& store, const MadeUpRows& size) {
    Store(store, Store::Access::ReadWrite);
    const auto database = open_database(store / "results.sqlite", Database::Access::ReadWrite);
    Plan plan{.experiment = "million",
              .description = "",
              .scenes = {},
              .methods = {},
              .budgets = {SampleBudget{16}},
              .baseline = "method0",
              .metrics = {"mse", "relmse.eps0.01", "relmse.eps0.01.trim0.001"},
              .cells = {},
              .configuration = "{}"};
    for (int s = 0; s < size.n_scenes; ++s) {
        plan.scenes.push_back({.name = fmt::format("scene{}", s), .exposure = 0});
    }
    for (int m = 0; m < size.n_methods; ++m) plan.methods.push_back(fmt::format("method{}", m));
    Transaction transaction(*database);
    database
        ->prepare(
            "INSERT INTO experiments (name, submitted_at_ms, file_sha256, head) "
            "VALUES ('million', 1, '', ?1)")
        .bind(plan_to_json(plan).dump())
        .run();
    database->execute(fmt::format(R"sql(
CREATE TEMP TABLE n AS WITH RECURSIVE count(i) AS (
    SELECT 0 UNION ALL SELECT i + 1 FROM count WHERE i + 1 < {0} * {1} * {2})
SELECT i, format('%016x%016x', (i * 2654435761) % 4294967296, i) AS id,
       i % {1} AS method, i / {1} % {0} AS scene, i / ({0} * {1}) + 1 AS seed FROM count;
INSERT INTO tasks SELECT id, '{{"parameters":{{"max_depth":' || (method + 1) || '}}}}', '', i, 'done',
    1, 'worker', 0, 0, '' FROM n;
INSERT INTO tasks VALUES ('a', '{{}}', '', -1, 'done', 1, '', 0, 0, ''),
                         ('b', '{{}}', '', -2, 'done', 1, '', 0, 0, '');
INSERT INTO cells SELECT 'million', i, 'scene' || scene, 'method' || method, '16 spp', seed, 'test',
    id, 'a', 'b' FROM n;
INSERT INTO runs SELECT id, '', '', 8, 8, 'path', 1, '{{}}', '16 spp', 1, 1, 16, 1, 1.5,
    2.5 + seed % 7, 1000, 0, 0, 0, 0.0, 'worker', 1, '', 'build', 'cpu', 'isa', 'compiler', '', 'host'
    FROM (SELECT id, seed FROM n UNION ALL SELECT 'a', 1 UNION ALL SELECT 'b', 1);
INSERT INTO measurements SELECT id, 0, 'a', 'b', metric,
    (1 + ((i * 7919 + seed * 104729) % 1000) / 1000.0) * pow(0.97, method)
    FROM n, (SELECT 'mse' AS metric UNION ALL SELECT 'relmse.eps0.01'
             UNION ALL SELECT 'relmse.eps0.01.trim0.001' UNION ALL SELECT 'm4' UNION ALL SELECT 'm5');
INSERT INTO reference_noise SELECT id, 'a', 'b', 0.001 * seed FROM n;
)sql",
                                  size.n_scenes, size.n_methods, size.n_seeds));
    transaction.commit();
}

}  // namespace misbench
