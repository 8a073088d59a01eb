// misbench import: images of other renderers into a store.
#include <fmt/format.h>

#include "experiments/cli/estimate.h"
#include "experiments/cli/image_list.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/plan/imported.h"
#include "renderer/base/error.h"
#include "renderer/base/log.h"

namespace misbench {
namespace {

constexpr std::int64_t kReferenceSeed = 1'000'001;
constexpr std::size_t kMaxNamed = 3;

[[noreturn]] void fail_usage(const std::string& message) {
    throw Error(Errc::InvalidArgument, message);
}

// What the command line says of every image.
Fields given_fields(const ImportOptions& options) {
    Fields fields;
    const auto set = [&fields](const char* name, const std::string& value) {
        if (!value.empty()) fields[name] = value;
    };
    set("scene", options.scene);
    set("method", options.method);
    set("samples", options.samples);
    set("seconds", options.seconds);
    set("clock", options.clock);
    set("budget", options.budget);
    set("passes", options.passes);
    set("renderer", options.renderer);
    return fields;
}

// Seeds count up from the one that is given.
std::vector<ImageToImport> listed_images(const std::vector<std::string>& files, Fields fields,
                                         std::int64_t seed) {
    std::vector<ImageToImport> images;
    for (const std::string& file : files) {
        fields["seed"] = std::to_string(seed++);
        images.push_back(image_of(file, fields));
    }
    return images;
}

std::vector<ImageToImport> images_to_import(const ImportOptions& options) {
    const Fields given = given_fields(options);
    if (!options.pattern.empty()) {
        if (options.images.size() != 1) fail_usage("import: --pattern goes with one folder");
        std::vector<std::string> passed_over;
        auto images = images_below(options.images[0], options.pattern, given, passed_over);
        if (!passed_over.empty()) {
            const bool is_many = passed_over.size() > kMaxNamed;
            const std::size_t n_more = passed_over.size() - kMaxNamed;
            if (is_many) passed_over.resize(kMaxNamed);
            print_note(fmt::format("passed over what does not fit the pattern: {}{}",
                                   fmt::join(passed_over, " "),
                                   is_many ? fmt::format(" and {} more", n_more) : ""));
        }
        return images;
    }
    std::vector<ImageToImport> images;
    if (!options.list.empty()) images = images_of_list(options.list, given);
    for (ImageToImport& image : listed_images(options.images, given, options.seed)) {
        images.push_back(std::move(image));
    }
    // What is said of the tested images is not said of the reference.
    Fields reference{
        {"scene", options.scene}, {"method", kReferenceLabel}, {"renderer", options.renderer}};
    for (ImageToImport& image : listed_images(options.references, reference, kReferenceSeed)) {
        images.push_back(std::move(image));
    }
    return images;
}

// What to do next, as can be pasted.
std::string next_steps(const ImportOptions& options, const Plan& plan) {
    std::string text;
    const std::vector<std::string> missing = scenes_without_reference(plan);
    if (!missing.empty()) {
        text += fmt::format(
            "no errors yet of {}: no reference; give two independent images:\n"
            "  misbench import {} --experiment {} --scene {} --reference A B\n",
            fmt::join(missing, ", "), options.store, plan.experiment, missing[0]);
    }
    if (missing.size() < plan.scenes.size()) {
        text += fmt::format(
            "  misbench table {0} --experiment {1}\n"
            "  misbench report {0} --experiment {1}\n",
            options.store, plan.experiment);
    }
    return text;
}

int remove_verb(const ImportOptions& options) {
    const int n = remove_images(options.store, options.experiment, options.remove, options.scene);
    print_result(fmt::format("{} image{} of '{}' removed from experiment '{}' of store '{}'\n", n,
                             n == 1 ? "" : "s", options.remove, options.experiment, options.store));
    return 0;
}

}  // namespace

int import_verb(const ImportOptions& options) {
    init_log("misbench", "warn");
    if (!options.remove.empty()) return remove_verb(options);
    ImportRequest request{.experiment = options.experiment,
                          .images = images_to_import(options),
                          .metrics = options.metrics,
                          .baseline = options.baseline,
                          .replace = options.replace,
                          .one_reference = options.one_reference,
                          .layer = options.layer};
    const ParameterMap parameters = parse_parameters(options.parameters);
    for (ImageToImport& image : request.images) {
        if (image.method != kReferenceLabel) image.parameters = parameters;
    }
    const Imported imported = import_images(options.store, request);
    for (const std::string& what : imported.invalid) print_note("invalid: " + what);
    print_result(fmt::format("{} imported, {} there before, {} errors measured; experiment '{}' of "
                             "store '{}'\n",
                             imported.n_new, imported.n_known, imported.n_measured,
                             options.experiment, options.store) +
                 next_steps(options, imported.plan));
    return 0;
}

}  // namespace misbench
