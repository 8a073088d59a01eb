// One target as libFuzzer wants it; which one is told to the compiler.
#include <cstdlib>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
    for (const misbench::fuzz::Target& target : misbench::fuzz::targets()) {
        if (target.name != MISBENCH_FUZZ_TARGET) continue;
        target.run(std::as_bytes(std::span(bytes, size)));
        return 0;
    }
    std::abort();
}
