// Images of other renderers in a plan. Their cells have tasks that nobody renders: the method is
// "imported:LABEL", and what was imported is a part of the identity. A label stands for one or the
// other, never for both.
#pragma once

#include <string>
#include <vector>

#include "experiments/plan/experiment.h"

namespace misbench {

// Of a reference's halves, where a method has its label.
inline constexpr const char* kReferenceLabel = "reference";

// The parameter that holds what was imported: a hash of the image and of what was said of it.
inline constexpr const char* kImportParameter = "import";

// Where the name and version of the renderer are not known.
inline constexpr const char* kUnknownRenderer = "unknown";

std::string imported_method(const std::string& label);
bool is_imported(const Task& task);
// Stands for the content of a scene of which only the name is known.
std::string imported_scene_hash(const std::string& scene);

// Scenes whose images have nothing to be compared with.
std::vector<std::string> scenes_without_reference(const Plan& plan);

// The order of plans that are put together from pieces: references first, then tests by seed,
// budget, scene and method.
void sort_cells(Plan& plan);

// Adds the cell of an imported image, and its scene, method and budget where the plan lacks them.
// Another image in its place is replaced if `replace`. Throws InvalidArgument where the place is
// taken otherwise, where misbench renders the label or the reference, and for another image size
// than the scene has. An experiment that misbench renders gets no new scenes.
void add_imported(Plan& plan, const Cell& cell, bool replace);

// Takes the images of a label out of the plan, of all scenes or of those named; returns how many. A
// label, budget or scene that nothing is left of goes too, unless an experiment's file has it.
// Throws InvalidArgument where misbench renders the label, where no image has it, and where a claim
// is about it.
int remove_imported(Plan& plan, const std::string& label, const std::string& scene);

// The imported cells of `before` that the plan does not have, added to it: an experiment's file
// knows nothing of them. Left out, and named in what is returned, are images of a scene whose
// content or size is another one now, and references that the plan has itself. Throws
// InvalidArgument where the plan renders a label that stands for images.
std::vector<std::string> keep_imported(Plan& plan, const Plan& before);

}  // namespace misbench
