// What is kept of one run beside its image: who did what, when, with what outcome. Written as
// record.json into the run's directory; the database can be rebuilt from these files.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "experiments/plan/task.h"
#include "renderer/base/render_statistics.h"
#include "renderer/base/snapshots.h"

namespace misbench {

// The machine and the program, as far as they can change numbers.
struct Provenance {
    std::string build_id;  // git describe at configure time
    std::string compiler;  // "GNU 12.2.0"
    std::string flags;
    std::string cpu_model;
    std::string isa;  // what Embree selected, for example "AVX512"
    std::string host;
    bool operator==(const Provenance&) const = default;
};

struct SnapshotRecord {
    SnapshotStatistics statistics;
    std::string image_sha256;  // of snapshot_file()'s bytes
    bool operator==(const SnapshotRecord&) const = default;
};

struct Record {
    static constexpr int kFormat = 3;
    static constexpr int kFormatWithoutSnapshots = 2;  // still read

    std::string run;  // = task_id(task)
    Task task;
    RenderStatistics statistics;
    bool valid = true;        // no non-finite sample, and no negative one that is not declared
    std::string description;  // what the method decided, as JSON text
    std::string worker;
    std::int64_t epoch = 0;
    std::string finished_at;  // ISO 8601, UTC
    Provenance provenance;
    std::string image_sha256;  // of image.exr's bytes; checked when a run is committed or reindexed
    std::vector<SnapshotRecord> snapshots = {};  // by growing samples
    bool operator==(const Record&) const = default;
};

nlohmann::json record_to_json(const Record& record);
// Throws DataLoss on a damaged or incomplete record, FailedPrecondition on an unknown format.
Record record_from_json(const nlohmann::json& json);

}  // namespace misbench
