// The images of all techniques as one file: Veach's pyramid.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/image/image.h"
#include "renderer/paths/technique_images.h"

namespace misbench {

// Layers "weighted.NAME" and "unweighted.NAME" for TechniqueImage::name(), and the image itself as
// the one without a name.
void write_pyramid_exr(const std::filesystem::path& path, const Image& image,
                       const std::vector<TechniqueImage>& techniques);

// A PNG in memory: a row for each path length, a column for each technique that has an image, the
// weighted ones above the unweighted. Cells are shrunk where the whole would be too large to look
// at.
std::string pyramid_png(const std::vector<TechniqueImage>& techniques, double exposure);

// A table laid out like the rows and columns of the PNG: how many percent of the image's mean come
// from a technique.
std::string pyramid_text(const Image& image, const std::vector<TechniqueImage>& techniques);

}  // namespace misbench
