// An invariant of ours that must hold in every build. A broken one aborts: the lease expires and
// somebody else continues, which is better than a wrong number in a table.
#pragma once

#include <cstdio>
#include <cstdlib>

// NOLINTNEXTLINE: a macro, because the place and the condition's text are wanted in the message.
#define MISBENCH_CHECK(condition)                                                              \
    do {                                                                                       \
        if (!(condition)) [[unlikely]] {                                                       \
            std::fprintf(stderr, "%s:%d: check failed: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                                      \
        }                                                                                      \
    } while (false)
