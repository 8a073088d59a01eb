// Runs every reader of foreign files over its corpus and over mutations of it, the same ones every
// time. The fuzzer (tests/fuzz/run.sh) searches further.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <random>

#include "renderer/base/files.h"
#include "tests/fuzz/targets.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

constexpr int kMutationsPerTarget = 1500;

std::vector<std::string> corpus(const fuzz::Target& target) {
    std::vector<fs::path> files;
    for (const auto& entry :
         fs::directory_iterator(fs::path(MISBENCH_FUZZ_CORPUS) / std::string(target.name))) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    std::vector<std::string> inputs;
    for (const fs::path& file : files) inputs.push_back(read_file(file));
    return inputs;
}

void run(const fuzz::Target& target, const std::string& input) {
    target.run(std::as_bytes(std::span(input)));
}

class Mutator {
 public:
    explicit Mutator(std::vector<std::string> inputs) : inputs_(std::move(inputs)) {}

    // One of the inputs with one to four things changed.
    std::string next() {
        std::string input = inputs_[below(inputs_.size())];
        for (std::size_t n = 1 + below(4); n > 0; --n) mutate(input);
        return input;
    }

 private:
    std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

    void mutate(std::string& input) {
        const std::size_t at = below(input.size());
        switch (below(6)) {
            case 0:  // Flip a bit.
                if (!input.empty()) input[at] = static_cast<char>(input[at] ^ (1 << below(8)));
                break;
            case 1:  // Write any byte.
                if (!input.empty()) input[at] = static_cast<char>(below(256));
                break;
            case 2:  // Cut the end off.
                input.resize(at);
                break;
            case 3:  // Go on as another input does.
                splice(input, at);
                break;
            case 4:
                replace_number(input, at);
                break;
            default:  // Say something twice.
                input.insert(at, input.substr(at, below(64)));
                break;
        }
    }

    void splice(std::string& input, std::size_t at) {
        const std::string& other = inputs_[below(inputs_.size())];
        input = input.substr(0, at) + other.substr(below(other.size()));
    }

    // Replaces the first number behind `at`, in text, or four bytes, by one that breaks things.
    void replace_number(std::string& input, std::size_t at) {
        constexpr std::array<std::string_view, 10> kNumbers = {
            "0", "-1", "255", "4294967295", "2147483648", "1e39", "-1e-60", "nan", "99999999", ""};
        const std::size_t begin = input.find_first_of("0123456789", at);
        if (begin == std::string::npos || below(4) == 0) {
            if (at + 4 <= input.size())
                input.replace(at, 4, below(2) == 0 ? "\xFF\xFF\xFF\x7F" : "\xFF\xFF\xFF\xFF");
            return;
        }
        const std::size_t end = input.find_first_not_of("0123456789.eE+-", begin);
        input.replace(begin, std::min(end, input.size()) - begin, kNumbers[below(kNumbers.size())]);
    }

    std::vector<std::string> inputs_;
    std::mt19937_64 random_{1};
};

class EveryReader : public testing::TestWithParam<fuzz::Target> {};

TEST_P(EveryReader, ReturnsForItsCorpusAndForMutationsOfIt) {
    const std::vector<std::string> inputs = corpus(GetParam());
    ASSERT_FALSE(inputs.empty());
    for (const std::string& input : inputs) run(GetParam(), input);
    run(GetParam(), "");
    Mutator mutator(inputs);
    for (int i = 0; i < kMutationsPerTarget; ++i) run(GetParam(), mutator.next());
}

INSTANTIATE_TEST_SUITE_P(Fuzz, EveryReader,
                         testing::ValuesIn(fuzz::targets().begin(), fuzz::targets().end()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace misbench
