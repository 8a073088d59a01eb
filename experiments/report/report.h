// The report: one HTML file that needs nothing else, neither network nor a file beside it.
#pragma once

#include <optional>
#include <string>

#include "experiments/plan/experiment.h"
#include "experiments/report/report_images.h"
#include "results/store.h"

namespace misbench {

// How far an experiment is that is still running.
struct Running {
    std::size_t n_tasks = 0;
    std::size_t n_done = 0;
    std::size_t n_failed = 0;
    // The page loads itself again after so many seconds, in the state in which it is looked at.
    double reload_seconds = 0;
};

struct ReportContents {
    SeedImages seeds = SeedImages::First;
    Precision precision = Precision::Half;
    std::optional<Running> running = {};
};

struct Report {
    std::string html;
    std::size_t n_images = 0;
};

// The claims and what was found of them; a table and charts for each metric; a viewer of the
// images; where the numbers come from, and what to doubt. The same store gives the same bytes.
Report make_report(const Store& store, const Plan& plan, const ReportContents& contents = {});

}  // namespace misbench
