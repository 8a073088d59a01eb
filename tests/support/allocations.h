// A test linked with allocations.cpp counts what it allocates.
#pragma once

#include <cstdint>

namespace misbench::test {

// By operator new, since the program began, on all threads.
std::int64_t n_allocations();

}  // namespace misbench::test
