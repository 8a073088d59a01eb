#include "results/reference_noise.h"

namespace misbench {

double reference_share(const Image& image, const ReferencePair& reference) {
    constexpr double kEpsilon = 0.01;
    double noise = 0;
    double naive = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const double r1 = reference.a.rgb[i];
        const double r2 = reference.b.rgb[i];
        const double mean = (r1 + r2) / 2;
        const double weight = 1 / (mean * mean + kEpsilon);
        noise += (r1 - r2) * (r1 - r2) / 4 * weight;
        const double error = static_cast<double>(image.rgb[i]) - mean;
        naive += error * error * weight;
    }
    if (noise == 0) return 0;
    // An image that is the reference's mean has no error of its own.
    return naive == 0 ? 1 : noise / naive;
}

}  // namespace misbench
