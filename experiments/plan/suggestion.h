// What to say of a name that nobody knows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace misbench {

// "unknown scene 'VeachMS' (did you mean 'VeachMIS'?); known: CornellBox VeachMIS". The question is
// left out where no known name is close.
std::string unknown_name(std::string_view kind, const std::string& name,
                         const std::vector<std::string>& known);

}  // namespace misbench
