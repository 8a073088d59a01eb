// The readers of foreign files, each as a function of any bytes at all: it returns, whatever they
// are. Anything but that (a crash, another exception than Error, a scene that contradicts itself)
// is a finding. The fuzzer's binaries and the smoke test run the same ones.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace misbench::fuzz {

struct Target {
    std::string_view name;  // and that of its folder in tests/fuzz/corpus
    void (*run)(std::span<const std::byte> input);
};

std::span<const Target> targets();

}  // namespace misbench::fuzz
