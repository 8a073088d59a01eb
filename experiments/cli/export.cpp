// misbench export: the images of an experiment as files with names for people, and lists of them
// that `misbench import` reads back.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <tuple>

#include "experiments/analysis/cell_images.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/plan/imported.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kList = "images.csv";
// Of the images on the way of runs: each is what a budget of so many samples gives.
constexpr const char* kSnapshotList = "snapshots.csv";
constexpr const char* kListHeader =
    "path,scene,method,seed,budget,passes,cpu_seconds,wall_seconds,renderer\n";

// As a part of a path: '/' stays, which makes folders of scenes such as Box/LightTop.
std::string as_path(const std::string& name) {
    std::string path;
    for (const char c : name) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                              (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_' ||
                              c == '+' || c == '/';
        path += is_plain ? c : '_';
    }
    return path;
}

class Exporter {
 public:
    Exporter(const ExportOptions& options, const Store& store, const Plan& plan)
        : options_(options), store_(store), plan_(plan), folder_(options.images) {}

    void export_all() {
        for (const PlannedScene& scene : plan_.scenes) {
            if (wants("references")) export_references(scene);
            for (const std::string& method : plan_.methods) {
                for (const Budget& budget : plan_.budgets) export_cell(scene, method, budget);
            }
        }
        write_file_durably(folder_ / kList, kListHeader + list_);
        if (!snapshot_list_.empty()) {
            write_file_durably(folder_ / kSnapshotList, kListHeader + snapshot_list_);
        }
    }

    int n_images() const { return n_images_; }
    int n_left_out() const { return n_left_out_; }

 private:
    bool wants(const std::string& what) const {
        return options_.what == "all" || options_.what == what;
    }

    // Writes the image under a path without extension; returns the path that it got.
    std::string write(const std::string& name, const Image& image, const PlannedScene& scene) {
        std::string path = as_path(name) + "." + options_.format;
        // Two labels may differ in characters that no path has.
        for (int n = 2; !paths_.insert(path).second; ++n) {
            path = as_path(name) + "-" + std::to_string(n) + "." + options_.format;
        }
        const fs::path file = folder_ / path;
        fs::create_directories(file.parent_path());
        if (options_.format == "exr") {
            write_exr(file, image, {{"scene", scene.name}});
        } else {
            write_file_durably(file, encode_png(image, scene.exposure));
        }
        ++n_images_;
        return path;
    }

    // A line of a list.
    static std::string line(const std::string& path, const Cell& cell, const Budget& budget,
                            const auto& statistics, const Record& record) {
        const auto known = [](double value) { return value > 0 ? fmt::format("{}", value) : ""; };
        const std::string& build = record.provenance.build_id;
        std::string renderer = is_imported(record.task) ? build : "misbench " + build;
        if (is_imported(record.task) && build == kUnknownRenderer) renderer.clear();
        return fmt::format("{},{},{},{},{},{},{},{},{}\n", escape_csv(path), escape_csv(cell.scene),
                           escape_csv(cell.method), cell.seed, to_string(budget),
                           statistics.passes > 0 ? std::to_string(statistics.passes) : "",
                           known(statistics.cpu_seconds), known(statistics.wall_seconds),
                           escape_csv(renderer));
    }

    // Neither a budget nor another budget's snapshot is that image already.
    bool is_new_point(const Cell& cell, std::int64_t samples) {
        const bool is_budget =
            std::ranges::find(plan_.budgets, Budget(SampleBudget{samples})) != plan_.budgets.end();
        return !is_budget && points_.insert({cell.scene, cell.method, cell.seed, samples}).second;
    }

    void export_run(const std::string& name, const Cell& cell, const PlannedScene& scene) {
        const std::optional<Record> record = store_.run(task_id(cell.task));
        if (!record) return;
        if (!record->valid) {
            ++n_left_out_;
            return;
        }
        list_ += line(write(name, store_.run_image(record->run), scene), cell, cell.budget,
                      record->statistics, *record);
        for (const SnapshotRecord& snapshot : record->snapshots) {
            const std::int64_t samples = snapshot.statistics.samples;
            const std::string path =
                write(name + "." + fs::path(snapshot_file(samples)).stem().string(),
                      store_.snapshot_image(record->run, samples), scene);
            if (!is_new_point(cell, samples)) continue;
            snapshot_list_ += line(path, cell, SampleBudget{samples}, snapshot.statistics, *record);
        }
    }

    void export_references(const PlannedScene& scene) {
        for (const Cell& cell : plan_.cells) {
            if (cell.scene != scene.name || cell.role == Role::Test) continue;
            export_run(
                scene.name + "/reference/" + (cell.role == Role::ReferenceA ? "half_a" : "half_b"),
                cell, scene);
        }
        if (const auto images = reference_images(store_, plan_, scene.name)) {
            write(scene.name + "/reference/mean", images->mean, scene);
        }
    }

    void export_cell(const PlannedScene& scene, const std::string& method, const Budget& budget) {
        std::string budget_name = to_string(budget);
        std::ranges::replace(budget_name, ' ', '_');
        const std::string folder = scene.name + "/" + method + "/" + budget_name + "/";
        if (wants("runs")) {
            for (const Cell& cell : plan_.cells) {
                if (cell.role == Role::Test && cell.scene == scene.name && cell.method == method &&
                    cell.budget == budget) {
                    export_run(folder + "seed" + std::to_string(cell.seed), cell, scene);
                }
            }
        }
        if (!wants("means")) return;
        const auto runs = finished_runs(store_, plan_, scene.name, method, budget);
        if (const auto mean = mean_image(store_, runs)) write(folder + "mean", *mean, scene);
        const auto error = standard_error_image(store_, runs);
        if (error) write(folder + "standard_error", *error, scene);
    }

    const ExportOptions& options_;
    const Store& store_;
    const Plan& plan_;
    fs::path folder_;
    std::set<std::string> paths_;
    std::string list_;
    std::string snapshot_list_;
    std::set<std::tuple<std::string, std::string, std::int64_t, std::int64_t>> points_;
    int n_images_ = 0;
    int n_left_out_ = 0;
};

}  // namespace

int export_verb(const ExportOptions& options) {
    const Store store(options.store, Store::Access::ReadOnly);
    const Plan plan = store.experiment(options.experiment);
    std::error_code ignored;
    if (fs::exists(options.images, ignored) && !fs::is_empty(options.images, ignored)) {
        throw Error(Errc::InvalidArgument,
                    "export to '" + options.images + "': the folder is there and not empty");
    }
    std::error_code error;
    fs::create_directories(options.images, error);
    if (error) {
        throw Error(Errc::InvalidArgument,
                    "export to '" + options.images + "': " + error.message());
    }
    Exporter exporter(options, store, plan);
    exporter.export_all();
    if (exporter.n_left_out() > 0) {
        print_note(fmt::format("left out {} invalid runs", exporter.n_left_out()));
    }
    print_result(fmt::format("{} images of experiment '{}' in '{}', listed in {}\n",
                             exporter.n_images(), plan.experiment, options.images,
                             (fs::path(options.images) / kList).string()));
    return 0;
}

}  // namespace misbench
