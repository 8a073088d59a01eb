#include "results/import.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "experiments/plan/imported.h"
#include "experiments/plan/suggestion.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/sha256.h"
#include "renderer/base/utc.h"
#include "renderer/image/decode.h"
#include "results/metrics/metrics.h"
#include "results/run_directory.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDefaultMetric = "relmse.eps0.01";
constexpr const char* kWorker = "import";

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
    throw Error(Errc::InvalidArgument, "import '" + file.string() + "': " + what);
}

// --- one image -----------------------------------------------------------------------------------

// Linear RGB. The pixels of files with alpha are taken as they are: they are what reached the
// sensor, and alpha says nothing of light.
Image read_image(const fs::path& file, const std::string& bytes, const std::string& layer) {
    const Pixels pixels = decode_image(bytes, "import '" + file.string() + "'", layer);
    const auto* values = std::get_if<std::vector<float>>(&pixels.values);
    if (values == nullptr) {
        fail(file,
             "its pixels are integers, encoded for display; errors are of linear radiance, "
             "as in EXR, PFM and HDR files");
    }
    Image image(pixels.width, pixels.height);
    const auto n = static_cast<std::size_t>(pixels.n_channels);
    for (std::size_t p = 0; p < image.n_pixels(); ++p) {
        for (std::size_t c = 0; c < 3; ++c) {
            image.rgb[3 * p + c] = (*values)[n * p + (n >= 3 ? c : 0)];
        }
    }
    return image;
}

bool is_finite(const Image& image, std::size_t pixel) {
    return std::all_of(&image.rgb[3 * pixel], &image.rgb[3 * pixel] + 3,
                       [](float value) { return std::isfinite(value); });
}

// What is known of an image once its file has been read, without its pixels.
struct Facts {
    const ImageToImport* image = nullptr;
    std::string file_sha256;
    std::string pixels_sha256;
    int width = 0;
    int height = 0;
    RenderStatistics statistics;
    Role role = Role::Test;
    Budget budget;
};

void count_pixels(const Image& image, RenderStatistics& statistics) {
    for (std::size_t p = 0; p < image.n_pixels(); ++p) {
        if (!is_finite(image, p)) {
            const auto width = static_cast<std::size_t>(image.width);
            if (statistics.nonfinite_samples++ == 0) {
                statistics.first_bad_sample = {.x = static_cast<int>(p % width),
                                               .y = static_cast<int>(p / width)};
            }
        } else if (std::min({image.rgb[3 * p], image.rgb[3 * p + 1], image.rgb[3 * p + 2]}) < 0) {
            ++statistics.negative_samples;
        }
    }
}

Budget budget_of(const ImageToImport& image) {
    if (image.budget) return *image.budget;
    // What a reference cost is nobody's concern.
    if (image.method == kReferenceLabel) return SampleBudget{image.passes.value_or(0)};
    fail(image.file,
         "give its samples or seconds, such as --samples 64: only what cost the same can be "
         "compared");
}

// Of the pixels alone: a file that was exported and comes back holds the same image.
std::string sha256_of(const Image& image) {
    return sha256_hex(
        {reinterpret_cast<const char*>(image.rgb.data()), image.rgb.size() * sizeof(float)});
}

Facts facts_of(const ImageToImport& image, const std::string& layer) {
    if (image.scene.empty()) fail(image.file, "give its scene");
    if (image.method.empty()) fail(image.file, "give its method, a label");
    if (image.parameters.contains(kImportParameter)) {
        fail(image.file, std::string("parameter '") + kImportParameter + "' is taken");
    }
    const std::string bytes = read_file(image.file);
    const Image pixels = read_image(image.file, bytes, layer);
    Facts facts{.image = &image,
                .file_sha256 = sha256_hex(bytes),
                .pixels_sha256 = sha256_of(pixels),
                .width = pixels.width,
                .height = pixels.height,
                .statistics = {},
                .budget = budget_of(image)};
    RenderStatistics& statistics = facts.statistics;
    count_pixels(pixels, statistics);
    const auto* samples = std::get_if<SampleBudget>(&facts.budget);
    const auto* time = std::get_if<TimeBudget>(&facts.budget);
    const auto planned = [time](BudgetClock clock) {
        return time != nullptr && time->clock == clock ? time->seconds : 0;
    };
    statistics.passes = image.passes.value_or(samples != nullptr ? samples->samples : 0);
    statistics.cpu_seconds = image.cpu_seconds.value_or(planned(BudgetClock::Cpu));
    statistics.wall_seconds = image.wall_seconds.value_or(planned(BudgetClock::Wall));
    return facts;
}

// --- all of them ---------------------------------------------------------------------------------

[[noreturn]] void refuse_halves(const std::string& scene, std::size_t n) {
    throw Error(Errc::InvalidArgument,
                "import the reference of scene '" + scene + "': " + std::to_string(n) +
                    (n == 1 ? " image; two independent halves are needed, whose noise then cancels "
                              "from every error; --reference-only-one makes do with one, whose "
                              "noise counts as error"
                            : " images; known: two halves, independent of each other"));
}

void require_different_places(const std::vector<ImageToImport>& images) {
    std::map<std::tuple<std::string, std::string, std::int64_t, std::string>, fs::path> places;
    for (const ImageToImport& image : images) {
        const bool is_reference = image.method == kReferenceLabel;
        const std::string budget = is_reference ? "" : to_string(budget_of(image));
        const auto [there, is_first] =
            places.try_emplace({image.scene, image.method, image.seed, budget}, image.file);
        if (is_first) continue;
        fail(image.file, "'" + there->second.string() + "' has the same scene, method, seed" +
                             (is_reference ? "" : " and budget"));
    }
}

// Which image is which half, by seed. A single one may stand for both.
void assign_halves(std::vector<Facts>& images, bool one_reference) {
    std::map<std::string, std::vector<Facts*>> references;
    std::vector<Facts> doubled;
    for (Facts& facts : images) {
        if (facts.image->method == kReferenceLabel) {
            references[facts.image->scene].push_back(&facts);
        }
    }
    for (auto& [scene, halves] : references) {
        if (halves.size() == 1 && one_reference) {
            halves[0]->role = Role::ReferenceA;
            doubled.push_back(*halves[0]);
            doubled.back().role = Role::ReferenceB;
            continue;
        }
        if (halves.size() != 2) refuse_halves(scene, halves.size());
        std::ranges::stable_sort(halves, {}, [](const Facts* f) { return f->image->seed; });
        const bool is_one = halves[0]->pixels_sha256 == halves[1]->pixels_sha256;
        if (is_one && !one_reference) {
            fail(halves[1]->image->file,
                 "both halves of the reference are the same image: they must be independent");
        }
        halves[0]->role = Role::ReferenceA;
        halves[1]->role = Role::ReferenceB;
    }
    images.insert(images.end(), doubled.begin(), doubled.end());
}

// The content of a scene is what the experiment's renders say; of others only the name is known.
std::string scene_hash_of(const Plan& plan, const std::string& scene) {
    for (const Cell& cell : plan.cells) {
        if (cell.scene == scene && !is_imported(cell.task)) return cell.task.scene_hash;
    }
    return imported_scene_hash(scene);
}

Cell cell_of(const Plan& plan, const Facts& facts) {
    const ImageToImport& image = *facts.image;
    ParameterMap parameters = image.parameters;
    // Other pixels, or other facts of the same pixels, are another run.
    parameters[kImportParameter] =
        sha256_hex(nlohmann::json{facts.pixels_sha256, image.renderer, facts.statistics.passes,
                                  facts.statistics.cpu_seconds, facts.statistics.wall_seconds}
                       .dump())
            .substr(0, 16);
    return {.scene = image.scene,
            .method = image.method,
            .budget = facts.budget,
            .seed = image.seed,
            .role = facts.role,
            .task = {.scene_hash = scene_hash_of(plan, image.scene),
                     .width = facts.width,
                     .height = facts.height,
                     .method = imported_method(image.method),
                     .method_version = 0,
                     .parameters = std::move(parameters),
                     .budget = facts.budget,
                     .seed = image.seed,
                     .scene = image.scene,
                     .scene_file = ""}};
}

Plan new_plan(const std::string& name) {
    const nlohmann::json configuration = {{"name", name}, {"methods", nlohmann::json::object()}};
    return {.experiment = name,
            .description = "imported images",
            .scenes = {},
            .methods = {},
            .budgets = {},
            .baseline = "",
            .metrics = {},
            .cells = {},
            .configuration = configuration.dump()};
}

// The experiment with all images in it. Pure.
Plan with_images(Plan plan, const ImportRequest& request, const std::vector<Facts>& images) {
    for (const Facts& facts : images) {
        try {
            add_imported(plan, cell_of(plan, facts), request.replace);
        } catch (const Error& e) {
            fail(facts.image->file, e.what());
        }
    }
    sort_cells(plan);
    for (const std::string& id : request.metrics) {
        find_metric(id);
        if (std::ranges::find(plan.metrics, id) == plan.metrics.end()) plan.metrics.push_back(id);
    }
    if (plan.metrics.empty()) plan.metrics.emplace_back(kDefaultMetric);
    if (request.baseline.empty()) return plan;
    if (std::ranges::find(plan.methods, request.baseline) == plan.methods.end()) {
        throw Error(Errc::InvalidArgument,
                    unknown_name("baseline", request.baseline, plan.methods));
    }
    plan.baseline = request.baseline;
    return plan;
}

std::string why_invalid(const Facts& facts) {
    const SamplePlace first = facts.statistics.first_bad_sample.value();
    return "'" + facts.image->file.string() +
           "': " + std::to_string(facts.statistics.nonfinite_samples) +
           " pixels are not finite, the first at " + std::to_string(first.x) + "," +
           std::to_string(first.y);
}

// Reads the image again: of a thousand images not all fit into memory.
void commit_image(Store& store, const Task& task, const Facts& facts, const std::string& layer) {
    const fs::path& file = facts.image->file;
    const std::string bytes = read_file(file);
    if (sha256_hex(bytes) != facts.file_sha256) fail(file, "it changed while it was imported");
    const std::string id = task_id(task);
    const fs::path staged = store.stage(id, 0);
    write_exr(staged / kImageFile, read_image(file, bytes, layer),
              {{"run", id}, {"scene", task.scene}, {"method", task.method}});
    const std::string& renderer = facts.image->renderer;
    const std::string now = utc_now();
    const nlohmann::json origin = {{"imported",
                                    {{"file", fs::absolute(file).string()},
                                     {"sha256", facts.file_sha256},
                                     {"renderer", renderer},
                                     {"at", now}}}};
    const Record record{.run = id,
                        .task = task,
                        .statistics = facts.statistics,
                        .valid = facts.statistics.nonfinite_samples == 0,
                        .description = origin.dump(),
                        .worker = kWorker,
                        .epoch = 0,
                        .finished_at = now,
                        .provenance = {.build_id = renderer.empty() ? kUnknownRenderer : renderer,
                                       .compiler = "",
                                       .flags = "",
                                       .cpu_model = "",
                                       .isa = "",
                                       .host = ""},
                        .image_sha256 = sha256_hex(read_file(staged / kImageFile))};
    write_file_durably(staged / kRecordFile, record_to_json(record).dump(2) + "\n");
    store.commit_run(staged);
}

Plan plan_in(const Store& store, const std::string& name) {
    const std::vector<std::string> known = store.experiments();
    const bool is_there = std::ranges::find(known, name) != known.end();
    return is_there ? store.experiment(name) : new_plan(name);
}

}  // namespace

Imported import_images(const fs::path& folder, const ImportRequest& request) {
    experiment_path(folder, request.experiment);
    if (request.images.empty()) throw Error(Errc::InvalidArgument, "import: no images are given");
    require_different_places(request.images);
    std::vector<Facts> images;
    for (const ImageToImport& image : request.images)
        images.push_back(facts_of(image, request.layer));
    assign_halves(images, request.one_reference);
    // What is wrong by itself makes no store.
    if (!fs::exists(folder)) with_images(new_plan(request.experiment), request, images);

    Store store(folder, Store::Access::ReadWrite);
    const Plan before = plan_in(store, request.experiment);
    Imported result;
    result.plan = with_images(before, request, images);
    std::set<std::string> seen;
    for (const Facts& facts : images) {
        const Task task = cell_of(before, facts).task;
        if (!seen.insert(task_id(task)).second) continue;
        if (facts.statistics.nonfinite_samples > 0) {
            result.invalid.push_back(why_invalid(facts));
        }
        const bool is_known = store.has_run(task_id(task));
        if (!is_known) commit_image(store, task, facts, request.layer);
        ++(is_known ? result.n_known : result.n_new);
    }
    if (result.plan != before) store.put_experiment(result.plan);
    result.n_measured = store.measure(result.plan);
    return result;
}

int remove_images(const fs::path& folder, const std::string& experiment, const std::string& label,
                  const std::string& scene) {
    Store(folder, Store::Access::ReadOnly).experiment(experiment);  // makes no store
    Store store(folder, Store::Access::ReadWrite);
    Plan plan = store.experiment(experiment);
    const int n_removed = remove_imported(plan, label, scene);
    store.put_experiment(plan, Store::ImportedImages::AsPlanned);
    store.measure(plan);
    return n_removed;
}

}  // namespace misbench
