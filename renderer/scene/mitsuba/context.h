// What the readers of all parts of a scene share.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "renderer/scene/description.h"

namespace misbench::mitsuba {

struct Context {
    std::filesystem::path folder;
    bool is_old = false;  // version 0.6
    SceneDescription scene{};

    // Each note once: a scene repeats its habits.
    void note(const std::string& text) {
        auto& notes = scene.notes;
        if (std::find(notes.begin(), notes.end(), text) == notes.end()) notes.push_back(text);
    }
};

}  // namespace misbench::mitsuba
