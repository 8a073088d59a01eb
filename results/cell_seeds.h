// The runs of an experiment as tables ask for them: by cell, all seeds at once.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "results/record.h"

namespace misbench {

// What became of one seed of a cell.
enum class SeedState : char { Valid = 'v', Invalid = 'i', Failed = 'f', Unfinished = 'u' };

// The tested seeds of one scene, method and budget, in the plan's order: element i of every list
// is about seeds[i].
struct CellSeeds {
    std::string scene;
    std::string method;      // the label
    std::string budget;      // as to_string(Budget)
    std::string parameters;  // effective ones of the method, as JSON
    std::string states;      // a SeedState each
    std::vector<std::int64_t> seeds;
    // 0 where there is no run.
    std::vector<double> passes;
    std::vector<double> wall_seconds;
    std::vector<double> cpu_seconds;
    std::vector<double> rays;
    // Of the reference's variance in the error (reference_noise.h); NaN where it is not measured.
    std::vector<double> reference_shares;
    std::map<std::string, std::vector<double>> values;  // by metric; NaN where there is none

    SeedState state(std::size_t i) const { return static_cast<SeedState>(states[i]); }
};

// Of the seeds that have one.
std::optional<double> mean_reference_share(const CellSeeds& cell);

// The runs of one machine and one build.
struct Origin {
    Provenance provenance;
    int threads = 0;
    int n_runs = 0;
    bool operator==(const Origin&) const = default;
};

}  // namespace misbench
