// Moments of images over seeds, by pixel and channel: what error maps, standard errors and tests
// are made of. The store keeps those of each cell with two valid seeds or more:
//
//   STORE/moments/ID.exr   R G B: the mean; m2.R m2.G m2.B: the sum of squared distances from it;
//                          attribute `runs`: the sorted ids of the runs, whose SHA-256 ID begins
//
// They follow from the runs and are never more than a shortcut: a file that is gone, damaged or of
// other runs is passed over.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/image/image.h"

namespace misbench {

class Database;

inline constexpr const char* kMomentsFolder = "moments";

struct PixelMoments {
    int n = 0;  // images
    Image mean;
    Image m2;
};

// Sums over images of one size, in double.
class MomentSums {
 public:
    void add(const Image& image);
    // As if the other's images had been added here, up to rounding.
    void merge(const MomentSums& other);
    // REQUIRES: at least one image.
    PixelMoments moments() const;

 private:
    int width_ = 0;
    int height_ = 0;
    int n_ = 0;
    std::vector<double> sums_;
    std::vector<double> m2_;
};

// The moments of these runs' images, in any order: read where they are kept, else computed.
PixelMoments read_or_compute_moments(const std::filesystem::path& store,
                                     const std::vector<std::string>& runs);

// Makes the files of all cells of all experiments that lack theirs, and removes those that no cell
// asks for. Returns how many were made.
int update_moments(const Database& database, const std::filesystem::path& store);

}  // namespace misbench
