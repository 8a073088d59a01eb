#include "results/record.h"

#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>

#include "renderer/base/error.h"

namespace misbench {
namespace {

using nlohmann::json;

template <typename T, typename Struct>
concept MaybeConst = std::same_as<std::remove_const_t<T>, Struct>;

// One list of fields for each struct, walked by the writer and by the reader.
void fields(MaybeConst<RenderStatistics> auto& statistics, auto&& field) {
    field("passes", statistics.passes);
    field("threads", statistics.threads);
    field("load_seconds", statistics.load_seconds);
    field("build_seconds", statistics.build_seconds);
    field("wall_seconds", statistics.wall_seconds);
    field("cpu_seconds", statistics.cpu_seconds);
    field("training_passes", statistics.training_passes);
    field("training_wall_seconds", statistics.training_wall_seconds);
    field("training_cpu_seconds", statistics.training_cpu_seconds);
    field("precomputed_passes", statistics.precomputed_passes);
    field("precomputed_wall_seconds", statistics.precomputed_wall_seconds);
    field("precomputed_cpu_seconds", statistics.precomputed_cpu_seconds);
    field("discarded_wall_seconds", statistics.discarded_wall_seconds);
    field("discarded_cpu_seconds", statistics.discarded_cpu_seconds);
    field("rays", statistics.rays);
    field("nonfinite_samples", statistics.nonfinite_samples);
    field("negative_samples", statistics.negative_samples);
    field("first_bad_sample", statistics.first_bad_sample);
    field("involuntary_context_switches", statistics.involuntary_context_switches);
    field("steal_seconds", statistics.steal_seconds);
    field("peak_memory_bytes", statistics.peak_memory_bytes);
}

void fields(MaybeConst<Provenance> auto& provenance, auto&& field) {
    field("build_id", provenance.build_id);
    field("compiler", provenance.compiler);
    field("flags", provenance.flags);
    field("cpu_model", provenance.cpu_model);
    field("isa", provenance.isa);
    field("host", provenance.host);
}

void fields(MaybeConst<SamplePlace> auto& place, auto&& field) {
    field("x", place.x);
    field("y", place.y);
    field("pass", place.pass);
}

void fields(MaybeConst<SnapshotStatistics> auto& snapshot, auto&& field) {
    field("samples", snapshot.samples);
    field("passes", snapshot.passes);
    field("wall_seconds", snapshot.wall_seconds);
    field("cpu_seconds", snapshot.cpu_seconds);
    field("training_passes", snapshot.training_passes);
    field("training_wall_seconds", snapshot.training_wall_seconds);
    field("training_cpu_seconds", snapshot.training_cpu_seconds);
    field("rays", snapshot.rays);
}

void fields(MaybeConst<SnapshotRecord> auto& snapshot, auto&& field) {
    field("statistics", snapshot.statistics);
    field("image_sha256", snapshot.image_sha256);
}

void fields(MaybeConst<Record> auto& record, auto&& field) {
    field("run", record.run);
    field("task", record.task);
    field("statistics", record.statistics);
    field("valid", record.valid);
    field("description", record.description);
    field("worker", record.worker);
    field("epoch", record.epoch);
    field("finished_at", record.finished_at);
    field("provenance", record.provenance);
    field("image_sha256", record.image_sha256);
    field("snapshots", record.snapshots);
}

json written(const Task& task) { return task_to_json(task); }
json written(const std::string& text) { return text; }
json written(const std::optional<SamplePlace>& place);
json written(const std::vector<SnapshotRecord>& snapshots);
template <typename T>
requires std::is_arithmetic_v<T> json written(T number) { return number; }
template <typename T>
requires std::is_class_v<T> json written(const T& value) {
    json object = json::object();
    fields(value,
           [&object](const char* key, const auto& member) { object[key] = written(member); });
    return object;
}
json written(const std::optional<SamplePlace>& place) { return place ? written(*place) : json(); }
json written(const std::vector<SnapshotRecord>& snapshots) {
    json list = json::array();
    for (const SnapshotRecord& snapshot : snapshots) list.push_back(written(snapshot));
    return list;
}

[[noreturn]] void throw_damaged(const std::string& path, const std::string& what) {
    throw Error(Errc::DataLoss, "read a run's record: '" + path + "' " + what);
}

void read(const json& value, const std::string& path, std::string& text) {
    if (!value.is_string()) throw_damaged(path, "is not a string");
    text = value.get<std::string>();
}

void read(const json& value, const std::string& path, bool& flag) {
    if (!value.is_boolean()) throw_damaged(path, "is neither true nor false");
    flag = value.get<bool>();
}

void read(const json& value, const std::string& path, double& number) {
    if (!value.is_number()) throw_damaged(path, "is not a number");
    number = value.get<double>();
}

void read(const json& value, const std::string& path, std::signed_integral auto& number) {
    using Number = std::remove_reference_t<decltype(number)>;
    if (!value.is_number_integer()) throw_damaged(path, "is not an integer");
    const auto wide = value.get<std::int64_t>();
    if (wide > std::numeric_limits<Number>::max() || wide < std::numeric_limits<Number>::min()) {
        throw_damaged(path, "is out of range");
    }
    number = static_cast<Number>(wide);
}

void read(const json& value, const std::string& path, Task& task) {
    try {
        task = task_from_json(value);
    } catch (const Error& e) {
        throw_damaged(path, std::string("is no task: ") + e.what());
    }
}

void read(const json& value, const std::string& path, std::optional<SamplePlace>& place);
void read(const json& value, const std::string& path, std::vector<SnapshotRecord>& snapshots);
template <typename T>
requires std::is_class_v<T>
void read(const json& value, const std::string& path, T& object) {
    if (!value.is_object()) throw_damaged(path, "is not an object");
    fields(object, [&](const char* key, auto& member) {
        const std::string inner = path.empty() ? key : path + "." + key;
        const auto found = value.find(key);
        if (found == value.end()) throw_damaged(inner, "is missing");
        read(*found, inner, member);
    });
}
void read(const json& value, const std::string& path, std::optional<SamplePlace>& place) {
    if (value.is_null()) {
        place.reset();
    } else {
        read(value, path, place.emplace());
    }
}
void read(const json& value, const std::string& path, std::vector<SnapshotRecord>& snapshots) {
    if (!value.is_array()) throw_damaged(path, "is not a list");
    for (const json& item : value) {
        const std::string inner = path + "." + std::to_string(snapshots.size());
        read(item, inner, snapshots.emplace_back());
    }
}

// Each is there under its own name, on the way to the image.
void check_snapshots(const Record& record) {
    std::int64_t samples = 0;
    for (const SnapshotRecord& snapshot : record.snapshots) {
        const SnapshotStatistics& at = snapshot.statistics;
        if (at.samples <= samples) throw_damaged("snapshots", "have no growing samples");
        if (at.passes < 1) throw_damaged("snapshots", "have one without passes");
        samples = at.samples;
    }
    if (!record.task.snapshots && !record.snapshots.empty()) {
        throw_damaged("snapshots", "were not asked for");
    }
}

}  // namespace

json record_to_json(const Record& record) {
    json object = written(record);
    object["format"] = Record::kFormat;
    return object;
}

Record record_from_json(const json& object) {
    if (!object.is_object()) throw_damaged("", "is not an object");
    int format = 0;
    if (!object.contains("format")) throw_damaged("format", "is missing");
    read(object["format"], "format", format);
    const bool has_snapshots = format != Record::kFormatWithoutSnapshots;
    if (has_snapshots && format != Record::kFormat) {
        throw Error(Errc::FailedPrecondition, "read a run's record: its format is " +
                                                  std::to_string(format) + ", this program reads " +
                                                  std::to_string(Record::kFormatWithoutSnapshots) +
                                                  " and " + std::to_string(Record::kFormat));
    }
    Record record;
    json whole = object;
    if (!has_snapshots) whole["snapshots"] = json::array();
    read(whole, "", record);
    if (record.run != task_id(record.task)) throw_damaged("run", "is not the id of its task");
    if (record.task.width <= 0 || record.task.height <= 0) throw_damaged("task", "has no pixels");
    if (record.statistics.passes < 0) throw_damaged("statistics.passes", "is negative");
    check_snapshots(record);
    return record;
}

}  // namespace misbench
