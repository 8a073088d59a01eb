// Images of other renderers as runs of equal standing: converted to float RGB, with a record that
// says where they come from, in cells of an experiment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/plan/experiment.h"
#include "results/store.h"

namespace misbench {

// What is said of an image file: what cannot be read from it.
struct ImageToImport {
    std::filesystem::path file;
    std::string scene;
    std::string method;  // the label; kReferenceLabel for a half of the scene's reference
    std::int64_t seed = 0;
    // What it was meant to spend, the axis of tables; only a reference may go without. Below what
    // it did spend: where that is not given the budget stands for it.
    std::optional<Budget> budget = {};
    std::optional<std::int64_t> passes = {};  // samples a pixel
    std::optional<double> cpu_seconds = {};
    std::optional<double> wall_seconds = {};
    std::string renderer = {};  // name and version, "" for unknown
    ParameterMap parameters = {};
};

struct ImportRequest {
    std::string experiment;  // made where the store has none of the name
    std::vector<ImageToImport> images;
    std::vector<std::string> metrics = {};  // added to the experiment's; none: the default
    std::string baseline = {};              // "" leaves it; the first method of a new experiment
    bool replace = false;                   // images in the place of others
    bool one_reference = false;             // a single image stands for both halves
    std::string layer = {};                 // of EXR files, as in decode_image()
};

struct Imported {
    int n_new = 0;
    int n_known = 0;  // were in the store before
    int n_measured = 0;
    Plan plan;
    std::vector<std::string> invalid;  // images with non-finite pixels, and how many
};

// All images are read and checked before the store, which is made if needed, changes. Runs that are
// replaced stay in it, without a cell. Throws InvalidArgument naming the file for what is wrong
// with an image or what is said of it.
Imported import_images(const std::filesystem::path& store, const ImportRequest& request);

// Takes the images of a label out of an experiment, as remove_imported() of a plan does; their runs
// stay in the store. Returns how many.
int remove_images(const std::filesystem::path& store, const std::string& experiment,
                  const std::string& label, const std::string& scene);

}  // namespace misbench
