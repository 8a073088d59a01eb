// misbench: the syntax of the verbs that keep a store in order.
#include <memory>

#include "experiments/cli/arguments.h"
#include "experiments/cli/verbs.h"

namespace misbench {
namespace {

void add_store_verb(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& help,
                    int (*function)(const StoreOptions&)) {
    const auto options = std::make_shared<StoreOptions>();
    CLI::App& verb = add_verb(app, name, help, function, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
}

void add_import(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ImportOptions>();
    CLI::App& verb = add_verb(app, "import", "take images of another renderer into a store",
                              import_verb, options, chosen);
    verb.footer(
        "For example, 64 samples a pixel of several methods, their references, and a mistake:\n"
        "  misbench import STORE --experiment NAME FOLDER --samples 64 \\\n"
        "      --pattern '{scene}/{method}-seed{seed}.exr'\n"
        "  misbench import STORE --experiment NAME --scene SCENE --reference A.exr B.exr\n"
        "  misbench import STORE --experiment NAME --remove METHOD");
    verb.add_option("store", options->store, "results store, made if needed")->required();
    verb.add_option("images", options->images,
                    "EXR, PFM or HDR files, of seeds that count up; with --pattern their folder");
    verb.add_option("--experiment", options->experiment, "its name, made if needed")->required();
    verb.add_option("--pattern", options->pattern,
                    "how paths below the folder tell fields, such as "
                    "'{scene}/{method}-seed{seed}.exr'; * stands for anything");
    verb.add_option("--list", options->list,
                    "CSV with a line of fields (path scene method seed samples seconds clock "
                    "budget passes cpu_seconds wall_seconds renderer), then a line an image");
    verb.add_option("--scene", options->scene, "its name");
    verb.add_option("--method", options->method, "the label in tables");
    verb.add_option("--seed", options->seed, "of the first image")->capture_default_str();
    verb.add_option("--samples", options->samples,
                    "a pixel, to compare at equal samples; the field {samples} where they differ");
    verb.add_option("--seconds", options->seconds, "what it took, to compare at equal time");
    verb.add_option("--clock", options->clock,
                    "cpu: seconds of all threads added up, or wall; default: cpu");
    verb.add_option("--budget", options->budget,
                    "what images are compared at, such as '10 s wall', where each took another "
                    "time");
    verb.add_option("--passes", options->passes, "samples a pixel, when compared at equal time");
    verb.add_option("--set", options->parameters, "KEY=VALUE: a parameter, for the record")
        ->allow_extra_args(false);
    verb.add_option("--renderer", options->renderer, "its name and version");
    verb.add_option("--reference", options->references,
                    "the two independent halves that images of the scene are compared with")
        ->expected(1, 2);
    verb.add_flag("--reference-only-one", options->one_reference,
                  "one image stands for both halves: its noise counts as error of all");
    verb.add_option("--metric", options->metrics, "its id, several times; default: relmse.eps0.01")
        ->allow_extra_args(false);
    verb.add_option("--baseline", options->baseline, "a label; default: the first");
    verb.add_option("--layer", options->layer, "of EXR files that have layers: its name");
    verb.add_flag("--replace", options->replace, "put images in the place of other ones");
    verb.add_option("--remove", options->remove,
                    "a method whose imported images leave the experiment, all or with --scene of "
                    "one scene")
        ->excludes("images")
        ->excludes("--list");
}

void add_export(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<ExportOptions>();
    CLI::App& verb = add_verb(app, "export", "write the images of an experiment as files",
                              export_verb, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
    verb.add_option("--images", options->images, "folder, made if needed; it must be empty")
        ->required();
    verb.add_option("--experiment", options->experiment, "its name; default: the latest");
    verb.add_option("--format", options->format, "exr or png")
        ->check(CLI::IsMember({"exr", "png"}))
        ->capture_default_str();
    verb.add_option("--what", options->what,
                    "runs, means over seeds with their standard errors, references or all")
        ->check(CLI::IsMember({"runs", "means", "references", "all"}))
        ->capture_default_str();
}

void add_merge(CLI::App& app, Chosen& chosen) {
    const auto options = std::make_shared<MergeOptions>();
    CLI::App& verb = add_verb(app, "merge", "copy runs and experiments of stores into another one",
                              merge_verb, options, chosen);
    verb.add_option("into", options->store, "results store, made if needed")->required();
    verb.add_option("from", options->from, "results stores, which are only read")->required();
    verb.add_flag("--rename", options->rename,
                  "take an experiment whose name is that of another one as NAME-2");
}

}  // namespace

void add_store_verbs(CLI::App& app, Chosen& chosen) {
    add_store_verb(app, chosen, "status", "count the tasks of a store's experiments", status_verb);
    add_store_verb(app, chosen, "reindex", "rebuild a store's database from its run directories",
                   reindex_verb);
    add_import(app, chosen);
    add_export(app, chosen);
    add_merge(app, chosen);
}

}  // namespace misbench
