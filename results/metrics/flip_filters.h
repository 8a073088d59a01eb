// The filters of FLIP: what the eye resolves of a colour, and detectors of edges and points. All
// are products of one row of weights and one column, or sums of two such products.
//
// [And20] P. Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020.
#pragma once

#include <array>
#include <vector>

namespace misbench {

// One channel of an image, row by row.
struct Plane {
    int width = 0;
    int height = 0;
    std::vector<float> values;

    Plane(int w, int h)
        : width(w),
          height(h),
          values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.0F) {}
};

using FilterWeights = std::vector<float>;  // of offsets -r … r

// Out of the image it goes on with its nearest pixel.
Plane filter_rows(const Plane& in, const FilterWeights& weights);
Plane filter_columns(const Plane& in, const FilterWeights& weights);

// The contrast sensitivity of the three channels of YCxCz: each sums to 1.              [And20]
struct ContrastFilters {
    // A normalised Gaussian, applied along both axes, and its share of the whole filter.
    struct Part {
        double share = 0;
        FilterWeights weights;
    };
    std::array<std::vector<Part>, 3> parts;
};
ContrastFilters contrast_filters(double pixels_per_degree);
Plane filter_contrast(const Plane& in, const std::vector<ContrastFilters::Part>& parts);

// A Gaussian and its first and second derivatives, as wide as an edge that is seen. The positive
// weights of a derivative sum to 1, the negative ones to -1, so a step or a line of height 1
// responds with at most 1.                                                              [And20]
struct FeatureFilters {
    FilterWeights smooth, edge, point;
};
FeatureFilters feature_filters(double pixels_per_degree);

// The length of the two directions' responses, for each pixel.
struct Features {
    Plane edges, points;
};
Features find_features(const Plane& in, const FeatureFilters& filters);

}  // namespace misbench
