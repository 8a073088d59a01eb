// That all estimators of a scene agree, as one expectation.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "tests/support/estimators.h"

namespace misbench::test {

// How many, and those of the smallest p-values.
inline std::string summary(std::vector<Difference> differences) {
    constexpr std::size_t kShown = 10;
    std::sort(differences.begin(), differences.end(),
              [](const Difference& a, const Difference& b) { return a.p_value < b.p_value; });
    std::string text = std::to_string(differences.size()) + " differences";
    for (std::size_t i = 0; i < std::min(kShown, differences.size()); ++i) {
        text += "\n  " + differences[i].text;
    }
    if (differences.size() > kShown) text += "\n  …";
    return text;
}

// Fails where a tile of a pair disagrees, and where a bias of the whole image that is
// larger than `detectable_bias` would not be found.
inline void expect_agreement(const Scene& scene, const ImageRequest& request,
                             const AgreementTest& test, double detectable_bias) {
    const std::vector<ImageSource> all = sources(scene, test.scene, request);
    ASSERT_GE(all.size(), 2U) << "estimators that find all light";
    const Agreement agreement = compare_all_pairs(all, test);
    std::cout << test.scene << ", paths of " << request.lengths.min_edges << " … "
              << request.lengths.max_edges << " edges: " << all.size() << " estimators, "
              << agreement.n_tests << " tests; detectable bias of a tile "
              << 100 * agreement.detectable_bias_of_tile << " %, of the image "
              << 100 * agreement.detectable_bias_of_image << " %\n";
    if (!agreement.withdrawn.empty()) {
        std::cout << "not confirmed by other seeds: " << summary(agreement.withdrawn) << '\n';
    }
    if (!agreement.disagreements.empty()) ADD_FAILURE() << summary(agreement.disagreements);
    EXPECT_LE(agreement.detectable_bias_of_image, detectable_bias) << "too noisy to say anything";
}

}  // namespace misbench::test
