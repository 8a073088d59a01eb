// Plans, runs and images without a renderer, for tests of what comes after it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "renderer/base/files.h"
#include "renderer/base/sha256.h"
#include "results/store.h"
#include "tests/support/temporary_folder.h"

namespace misbench {

inline Task made_up_task(const std::string& method, std::int64_t seed, Budget budget) {
    return {.scene_hash = sha256_hex("a box"),
            .width = 8,
            .height = 4,
            .method = method,
            .method_version = 1,
            .parameters = {{"max_depth", std::int64_t{3}}},
            .budget = budget,
            .seed = seed,
            .scene = "Box",
            .scene_file = "scenes/Box.json"};
}

// One scene, methods "plain" (the baseline) and "clever", seeds 1 to n, both halves of a reference.
inline Plan made_up_plan(const std::string& name, int n_seeds, Budget budget = SampleBudget{16}) {
    Plan plan{.experiment = name,
              .description = "made up",
              .scenes = {{.name = "Box", .exposure = 0}},
              .methods = {"plain", "clever"},
              .budgets = {budget},
              .baseline = "plain",
              .metrics = {"relmse.eps0.01", "mse"},
              .cells = {},
              .configuration = "{}"};
    const Budget many = SampleBudget{1024};
    for (const Role role : {Role::ReferenceA, Role::ReferenceB}) {
        const std::int64_t seed = role == Role::ReferenceA ? 1001 : 1002;
        plan.cells.push_back({.scene = "Box",
                              .method = "reference",
                              .budget = many,
                              .seed = seed,
                              .role = role,
                              .task = made_up_task("plain", seed, many)});
    }
    for (std::int64_t seed = 1; seed <= n_seeds; ++seed) {
        for (const std::string& method : plan.methods) {
            plan.cells.push_back({.scene = "Box",
                                  .method = method,
                                  .budget = budget,
                                  .seed = seed,
                                  .role = Role::Test,
                                  .task = made_up_task(method, seed, budget)});
        }
    }
    return plan;
}

// Around 1 with noise that follows from the task's budget, method and seed.
inline Image made_up_image(const Task& task) {
    Image image(task.width, task.height);
    std::mt19937 random(static_cast<unsigned>(task.seed) + (task.method == "plain" ? 0U : 500U));
    const auto* samples = std::get_if<SampleBudget>(&task.budget);
    const double spread =
        (task.method == "plain" ? 1.0 : 0.5) /
        std::sqrt(samples != nullptr ? static_cast<double>(samples->samples) : 16.0);
    std::normal_distribution<double> noise(1, spread);
    for (float& value : image.rgb) value = static_cast<float>(noise(random));
    return image;
}

inline Record made_up_record(const Task& task) {
    return {.run = task_id(task),
            .task = task,
            .statistics = {.passes = 16,
                           .threads = 2,
                           .load_seconds = 0.25,
                           .build_seconds = 0.125,
                           .wall_seconds = 1.5,
                           .cpu_seconds = 2.75,
                           .training_passes = 2,
                           .training_wall_seconds = 0.75,
                           .training_cpu_seconds = 1.25,
                           .precomputed_passes = 3,
                           .precomputed_wall_seconds = 4.5,
                           .precomputed_cpu_seconds = 8.5,
                           .discarded_wall_seconds = 0.0625,
                           .discarded_cpu_seconds = 0.03125,
                           .rays = 123456,
                           .nonfinite_samples = 0,
                           .negative_samples = 0,
                           .first_bad_sample = std::nullopt,
                           .involuntary_context_switches = 7,
                           .steal_seconds = 0.5,
                           .peak_memory_bytes = 1 << 20},
            .valid = true,
            .description = "{}",
            .worker = "host-1-2",
            .epoch = 5,
            .finished_at = "2026-01-02T03:04:05Z",
            .provenance = {.build_id = "abc",
                           .compiler = "GNU 12.2.0",
                           .flags = "-O3",
                           .cpu_model = "a CPU",
                           .isa = "AVX2",
                           .host = "host"},
            .image_sha256 = ""};
}

// Noisier than the run's, as if after so many samples.
inline Image made_up_snapshot_image(Task task, std::int64_t samples) {
    task.budget = SampleBudget{samples};
    return made_up_image(task);
}

inline SnapshotRecord made_up_snapshot(const Task& task, std::int64_t samples) {
    const auto n = static_cast<double>(samples);
    return {.statistics = {.samples = samples,
                           .passes = samples,
                           .wall_seconds = 0.0625 * n,
                           .cpu_seconds = 0.125 * n,
                           .training_passes = 1,
                           .training_wall_seconds = 0.0625,
                           .training_cpu_seconds = 0.125,
                           .rays = 1000 * samples},
            .image_sha256 = sha256_hex(task.method + std::to_string(samples))};
}

using RecordChange = std::function<void(Record&)>;

// What a worker uploads: the files in a staged folder.
inline std::filesystem::path stage_made_up_run(const Store& store, const Task& task,
                                               const RecordChange& change = {}) {
    Record record = made_up_record(task);
    const auto folder = store.stage(record.run, record.epoch);
    write_exr(folder / "image.exr", made_up_image(task));
    record.image_sha256 = sha256_hex(read_file(folder / "image.exr"));
    const auto* samples = std::get_if<SampleBudget>(&task.budget);
    for (std::int64_t n = 1; task.snapshots && samples != nullptr && n < samples->samples; ++n) {
        if (!is_rung(*task.snapshots, n)) continue;
        const auto file = folder / snapshot_file(n);
        write_exr(file, made_up_snapshot_image(task, n));
        record.snapshots.push_back(made_up_snapshot(task, n));
        record.snapshots.back().image_sha256 = sha256_hex(read_file(file));
    }
    if (change) change(record);
    write_file_durably(folder / "record.json", record_to_json(record).dump(1));
    return folder;
}

inline Recorded commit_made_up_run(Store& store, const Task& task,
                                   const RecordChange& change = {}) {
    return store.commit_run(stage_made_up_run(store, task, change));
}

inline void commit_all(Store& store, const Plan& plan) {
    for (const Cell& cell : plan.cells) commit_made_up_run(store, cell.task);
}

// Every file below a folder with the hash of its bytes, to see whether anything has changed.
inline std::map<std::string, std::string> hashes_below(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        files[entry.path().lexically_relative(folder).string()] =
            entry.is_regular_file() ? sha256_hex(read_file(entry.path())).substr(0, 8) : "";
    }
    return files;
}

}  // namespace misbench
