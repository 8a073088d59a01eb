// File names that say what is in the file, such as {scene}/{method}-seed{seed}.exr.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace misbench {

// Of a path or a line of a list: what is said of its file, by name.
using Fields = std::map<std::string, std::string>;

class PathPattern {
 public:
    // {NAME} for each of the known names, once at most; * for anything within a folder's or file's
    // name; all else is itself. Throws InvalidArgument for another name.
    PathPattern(const std::string& pattern, const std::vector<std::string>& known);

    // What the fields are in a path, none of them empty; absent where the pattern does not fit. The
    // field `scene` may span folders, as names of scenes do. Throws InvalidArgument where it fits
    // in two ways.
    std::optional<Fields> match(const std::string& path) const;

 private:
    struct Part {
        enum class Kind { Text, Field, Any };
        Kind kind;
        std::string text;  // or the field's name
    };
    void match_from(std::size_t part, const std::string& path, std::size_t at, Fields& fields,
                    std::vector<Fields>& found) const;

    std::string pattern_;
    std::vector<Part> parts_;
};

}  // namespace misbench
