// How far a run is: one line in place on a terminal, a log line now and then elsewhere.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <utility>

#include "experiments/cost_model.h"
#include "proto/client.h"

namespace misbench {

enum class ProgressMode { Line, Log, Never };
// "auto" is Line when stderr is a terminal that can, else Log; "always" is Line.
ProgressMode progress_mode(const std::string& option);

using SteadyTime = std::chrono::steady_clock::time_point;

// Seconds until the end: the costs of what is left, scaled by how long finished tasks took against
// theirs. Guesses and measured costs are wrong in different ways, so each has a scale of its own.
class RemainingTime {
 public:
    // `costs` by task, of what is to do; `workers` work at a time.
    RemainingTime(std::map<std::string, Cost> costs, int workers)
        : costs_(std::move(costs)), workers_(workers) {}
    double estimate(const QueueStatus& status);

 private:
    struct Scale {
        double expected = 0;
        double taken = 0;
        double value() const { return expected > 0 ? taken / expected : 1; }
    };
    double scaled(const Cost& cost) const {
        return cost.seconds * (cost.is_guess ? guessed_ : measured_).value();
    }

    std::map<std::string, Cost> costs_;
    std::map<std::string, double> last_seen_;  // seconds that a running task had been at work
    double workers_;
    Scale guessed_;
    Scale measured_;
};

class Progress {
 public:
    // `label` goes before what is shown in place.
    Progress(ProgressMode mode, RemainingTime remaining, std::string label)
        : mode_(mode), remaining_(std::move(remaining)), label_(std::move(label)) {}
    // A line in place is removed when this object goes.
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(const QueueStatus& status, SteadyTime now);
    // A log line for the end, whatever was shown before.
    void finish(const QueueStatus& status);
    // Makes room for another line on stderr.
    void clear();

 private:
    ProgressMode mode_;
    RemainingTime remaining_;
    std::string label_;
    SteadyTime last_log_{};
    bool is_shown_ = false;
};

}  // namespace misbench
