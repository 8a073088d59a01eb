// From a Mitsuba XML file, and the files that it includes, to objects.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {

// Names are in version 3's spelling whatever the file's version; $parameters are replaced and
// references point to their objects.
struct Document {
    bool is_old = false;  // version 0.6: other defaults, other names for a few things
    Object scene;         // its children are the top level
    std::deque<Object> objects;
    // The files that the scene refers to, includes too, in order of appearance, as written.
    std::vector<std::string> references;
};

// Throws NotFound or InvalidArgument: file, place, reason. Names of files are relative to the
// folder of `file`, in included files too.
Document read_document(const std::filesystem::path& file);

}  // namespace misbench::mitsuba
