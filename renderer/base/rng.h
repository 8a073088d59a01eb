// Counter-based random numbers: Philox4x32-10 [SMDS11] keyed by the seed, counted by (pixel or
// light path, pass, dimension). Any sample of any run can be computed again alone, in any order, on
// any thread.
//
// [SMDS11]  J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel random numbers: as easy as
//           1, 2, 3, 2011.
#pragma once

#include <Random123/philox.h>

#include <cstdint>

namespace misbench {

// What a sequence is for. Sequences of different streams are independent at equal pixel and pass.
enum class Stream : std::uint32_t { CameraPath = 0, LightPath = 1, LensOfLightPath = 2 };

class Rng {
 public:
    Rng(std::int64_t seed, std::uint32_t pixel_idx, std::uint32_t pass,
        Stream stream = Stream::CameraPath)
        : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}},
          counter_{{0, pixel_idx, pass, static_cast<std::uint32_t>(stream)}} {}

    // Uniform in [0, 1), a multiple of 2⁻²⁴: exact in float, and never 1.
    float uniform() {
        if (n_used_ == 4) {
            block_ = r123::Philox4x32()(counter_, key_);
            ++counter_.v[0];
            n_used_ = 0;
        }
        return static_cast<float>(block_.v[n_used_++] >> 8) * 0x1p-24F;
    }

 private:
    r123::Philox4x32::key_type key_;
    r123::Philox4x32::ctr_type counter_;
    r123::Philox4x32::ctr_type block_{};
    unsigned n_used_ = 4;
};

}  // namespace misbench
