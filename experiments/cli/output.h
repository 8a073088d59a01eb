// What verbs write: results to stdout, everything else to stderr.
#pragma once

#include <string>
#include <vector>

namespace misbench {

// Throws DataLoss when stdout does not take all of it (disk full).
void print_result(const std::string& text);

// "misbench: MESSAGE" as one line on stderr.
void print_note(const std::string& message);
// "misbench: error: MESSAGE" as one line on stderr; line breaks in the message become spaces.
void print_error(const std::string& message);

// Rows as lines with aligned columns.
std::string align(const std::vector<std::vector<std::string>>& rows);

}  // namespace misbench
