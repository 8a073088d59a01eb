// Stores of several machines or people as one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace misbench {

struct Merged {
    int n_runs = 0;   // copied
    int n_known = 0;  // were there
    // Of those that were there, the ones whose image is another one, by id: at equal time always,
    // at equal samples never as it should be. The first stays.
    std::vector<std::string> other_images;
    std::vector<std::string> experiments;  // that came or grew, by their name in the store
    int n_measured = 0;
};

// Copies the runs of `from` into the store `into`, which is made if needed, then its experiments:
// those of a name that is taken are united (experiments/plan/unite.h), or come as NAME-2 where they
// cannot be and `rename` is set. Stores in `from` are only read. A run is copied whole or not at
// all, and merging again goes on where it stopped. Throws InvalidArgument before anything is
// copied where experiments cannot be united, and like Store.
Merged merge_stores(const std::filesystem::path& into,
                    const std::vector<std::filesystem::path>& from, bool rename);

}  // namespace misbench
