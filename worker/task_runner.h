// Does a task: loads its scene, renders, and leaves images and record.json in a folder of the
// scratch directory. Keeps the last scene, because the tasks of a block share it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "proto/client.h"
#include "renderer/scene/load.h"
#include "results/record.h"
#include "worker/session.h"

namespace misbench {

class TaskRunner {
 public:
    TaskRunner(std::string worker, int threads, std::filesystem::path scratch);

    // One of the three places where exceptions end: they make a failed task.
    TaskOutcome run(const LeaseRef& lease, const Task& task,
                    const std::function<bool()>& abandon) noexcept;

 private:
    TaskOutcome render_task(const LeaseRef& lease, const Task& task,
                            const std::function<bool()>& abandon);
    const LoadedScene& scene_of(const Task& task);

    std::string worker_;
    int threads_;
    std::filesystem::path scratch_;
    Provenance provenance_;
    LoadedScene scene_;
    std::string scene_hash_;  // of scene_, "" before the first
};

}  // namespace misbench
