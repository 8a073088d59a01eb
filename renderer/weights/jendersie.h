// Factors of merging by the footprints of the camera's and the light's subpath, the baseline of
// grittmann2021. Its source is
//
// [Jen19]  J. Jendersie, Variance reduction via footprint estimation in the presence of path reuse,
//          2019,
//
// with the constants that grittmann2021's comparison uses.
#pragma once

#include <memory>

#include "renderer/paths/factor_provider.h"

namespace misbench {

std::shared_ptr<FactorProvider> make_jendersie();

}  // namespace misbench
