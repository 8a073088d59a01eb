// Factors of samples that share a prefix: they count as one.
//
// [PRDD15]  S. Popov, R. Ramamoorthi, F. Durand, G. Drettakis, Probabilistic connections for
//           bidirectional path tracing, 2015; for merging, grittmann2021 section 2.4.
#pragma once

#include <memory>

#include "renderer/paths/factor_provider.h"

namespace misbench {

std::shared_ptr<FactorProvider> make_popov();

}  // namespace misbench
