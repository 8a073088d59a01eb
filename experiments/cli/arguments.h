// The command line's syntax, by groups of verbs. Only the files arguments*.cpp and main.cpp know
// CLI11 (it costs seconds to compile): they turn a command line into the options of a verb
// (verbs.h).
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

namespace misbench {

using Chosen = std::function<int()>;

// A subcommand that, when it is the one, makes `chosen` call `verb` with its options.
template <typename Options>
CLI::App& add_verb(CLI::App& app, const std::string& name, const std::string& help,
                   int (*verb)(const Options&), const std::shared_ptr<Options>& options,
                   Chosen& chosen) {
    CLI::App* command = app.add_subcommand(name, help);
    command->callback([&chosen, verb, options] { chosen = [=] { return verb(*options); }; });
    return *command;
}

inline void add_scenes(CLI::App& verb, std::string& scenes) {
    verb.add_option("--scenes", scenes, "folder in which scenes are found by name");
}

void add_render_verbs(CLI::App& app, Chosen& chosen);
// `command_line` is how to resume.
void add_experiment_verbs(CLI::App& app, Chosen& chosen, const std::string& command_line);
void add_result_verbs(CLI::App& app, Chosen& chosen);
void add_store_verbs(CLI::App& app, Chosen& chosen);

}  // namespace misbench
