// Which images `misbench import` takes and what is said of them: from the command line, from the
// names of files, or from a list that `misbench export` or a user's script wrote. All three fill
// the same fields:
//
//   scene         its name
//   method        a label; "reference" for the halves of the scene's reference
//   seed          of the image
//   samples       a pixel: the budget of images that are compared at equal samples
//   seconds       and their clock: the budget of images that are compared at equal time; what they
//                 took where the budget is given otherwise
//   budget        what images are compared at, such as '10 s wall', whatever each of them took
//   passes        samples a pixel of images that are compared at equal time
//   cpu_seconds   what it took
//   wall_seconds
//   renderer      name and version
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/cli/path_pattern.h"
#include "results/import.h"

namespace misbench {

// Throws InvalidArgument naming the file and the field.
ImageToImport image_of(const std::filesystem::path& file, const Fields& fields);

// The files below `folder` that fit, sorted; `passed_over` gets the images that do not. `given` is
// said of all of them. Throws InvalidArgument where none fits.
std::vector<ImageToImport> images_below(const std::filesystem::path& folder,
                                        const std::string& pattern, const Fields& given,
                                        std::vector<std::string>& passed_over);

// A list in CSV: a line with the names of the fields, `path` among them, then a line for each
// image. Paths go from the list's folder. An empty field says nothing.
std::vector<ImageToImport> images_of_list(const std::filesystem::path& list, const Fields& given);

}  // namespace misbench
