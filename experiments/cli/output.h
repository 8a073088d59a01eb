// What verbs write: results to stdout, everything else to stderr.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

namespace misbench {

// Throws DataLoss when stdout does not take all of it (disk full).
void print_result(const std::string& text);

// "misbench: MESSAGE" as one line on stderr.
void print_note(const std::string& message);
// "misbench: error: MESSAGE" as one line on stderr; line breaks in the message become spaces.
void print_error(const std::string& message);

// Throws InvalidArgument unless the name of a file to write ends with one of the extensions.
void require_extension(const std::string& file, std::initializer_list<const char*> known);

// Rows as lines with aligned columns.
std::string align(const std::vector<std::vector<std::string>>& rows);

}  // namespace misbench
