#include "experiments/cli/output.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "experiments/report/numbers.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

std::string one_line(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

}  // namespace

void print_result(const std::string& text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (!written || std::fflush(stdout) != 0) {
        throw Error(Errc::DataLoss, std::string("write to stdout: ") + std::strerror(errno));
    }
}

void print_note(const std::string& message) {
    std::fprintf(stderr, "misbench: %s\n", one_line(message).c_str());
}

void print_error(const std::string& message) { print_note("error: " + message); }

void require_extension(const std::string& file, std::initializer_list<const char*> known) {
    const std::string extension = std::filesystem::path(file).extension();
    std::string names;
    for (const char* name : known) {
        if (extension == name) return;
        names.append(" ").append(name);
    }
    throw Error(Errc::InvalidArgument, "write '" + file + "': unknown extension; known:" + names);
}

std::string align(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t c = 0; c < row.size(); ++c) {
            widths[c] = std::max(widths[c], display_width(row[c]));
        }
    }
    std::string text;
    for (const auto& row : rows) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            text += padded(row[c], widths[c] + 2);
        }
        text.erase(text.find_last_not_of(' ') + 1);
        text += "\n";
    }
    return text;
}

}  // namespace misbench
