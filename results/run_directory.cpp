#include "results/run_directory.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/sha256.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// Of experiments/NAME.json.
constexpr int kExperimentFormat = 1;

std::string read_required(const fs::path& path) {
    try {
        return read_file(path);
    } catch (const Error& e) {
        throw Error(Errc::DataLoss, e.what());
    }
}

nlohmann::json parse(const fs::path& path, const std::string& bytes) {
    nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
    if (json.is_discarded()) {
        throw Error(Errc::DataLoss, "read '" + path.string() + "': it is not whole JSON");
    }
    return json;
}

bool is_name(const std::string& name) {
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '.' || c == '-' || c == '_';
    };
    return !name.empty() && name[0] != '.' && name.size() <= 200 &&
           std::ranges::all_of(name, allowed);
}

}  // namespace

Record read_record(const fs::path& run_folder) {
    const fs::path path = run_folder / kRecordFile;
    const nlohmann::json json = parse(path, read_required(path));
    try {
        return record_from_json(json);
    } catch (const Error& e) {
        throw Error(e.code(), "'" + path.string() + "': " + e.what());
    }
}

Record read_whole_run(const fs::path& run_folder) {
    Record record = read_record(run_folder);
    const auto check = [&run_folder](const std::string& file, const std::string& sha256) {
        const fs::path image = run_folder / file;
        if (sha256_hex(read_required(image)) == sha256) return;
        throw Error(Errc::DataLoss,
                    "read '" + image.string() + "': its bytes are not those its record names");
    };
    check(kImageFile, record.image_sha256);
    for (const SnapshotRecord& snapshot : record.snapshots) {
        check(snapshot_file(snapshot.statistics.samples), snapshot.image_sha256);
    }
    return record;
}

fs::path experiment_path(const fs::path& store, const std::string& name) {
    if (!is_name(name)) {
        throw Error(Errc::InvalidArgument, "experiment name '" + name +
                                               "': only letters, digits, '.', '-' and '_' are "
                                               "possible, and no '.' in front");
    }
    return store / "experiments" / (name + ".json");
}

ExperimentFile read_experiment_file(const fs::path& path) {
    const std::string bytes = read_required(path);
    const nlohmann::json json = parse(path, bytes);
    try {
        if (const int format = json.at("format"); format != kExperimentFormat) {
            throw Error(Errc::FailedPrecondition,
                        "read '" + path.string() + "': its format is " + std::to_string(format) +
                            ", this program reads " + std::to_string(kExperimentFormat));
        }
        ExperimentFile file{.plan = plan_from_json(json.at("plan")),
                            .submitted_at_ms = json.at("submitted_at_ms"),
                            .sha256 = sha256_hex(bytes)};
        if (file.plan.experiment != path.stem()) {
            throw Error(Errc::InvalidArgument, "it is about '" + file.plan.experiment + "'");
        }
        return file;
    } catch (const nlohmann::json::exception& e) {
        throw Error(Errc::DataLoss, "read '" + path.string() + "': " + e.what());
    } catch (const Error& e) {
        if (e.code() == Errc::FailedPrecondition) throw;
        throw Error(Errc::DataLoss, "read '" + path.string() + "': " + e.what());
    }
}

ExperimentFile write_experiment_file(const fs::path& store, const Plan& plan,
                                     std::int64_t submitted_at_ms) {
    const nlohmann::json json = {{"format", kExperimentFormat},
                                 {"submitted_at_ms", submitted_at_ms},
                                 {"plan", plan_to_json(plan)}};
    const std::string bytes = json.dump(1) + "\n";
    write_file_durably(experiment_path(store, plan.experiment), bytes);
    return {.plan = plan, .submitted_at_ms = submitted_at_ms, .sha256 = sha256_hex(bytes)};
}

}  // namespace misbench
