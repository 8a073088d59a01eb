// misbench, the command line tool: from a command line to a verb, and from an Error to an exit
// code.
#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "experiments/cli/arguments.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/plan/suggestion.h"
#include "renderer/base/build_info.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

// As a shell would take it.
std::string command_line_of(int argc, char** argv) {
    std::string line;
    for (int i = 0; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool is_plain =
            !argument.empty() &&
            argument.find_first_of(" \t\n'\"\\$`*?[](){}<>|&;#~!") == std::string::npos;
        std::string quoted;
        for (const char c : argument)
            quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += (i == 0 ? "" : " ") + (is_plain ? argument : "'" + quoted + "'");
    }
    return line;
}

// CLI11 would only say that a subcommand is required.
void require_known_verb(const CLI::App& app, int argc, char** argv) {
    const CLI::App* verb = &app;
    for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
        std::vector<std::string> known;
        for (const CLI::App* sub : verb->get_subcommands({})) known.push_back(sub->get_name());
        if (known.empty()) return;
        if (std::ranges::find(known, argv[i]) == known.end()) {
            throw Error(Errc::InvalidArgument, unknown_name("verb", argv[i], known));
        }
        verb = verb->get_subcommand(argv[i]);
    }
}

int run_program(int argc, char** argv) {
    CLI::App app("Compares Monte Carlo renderers: experiments, results, tables.", "misbench");
    app.set_version_flag("--version", fmt::format("misbench {} ({}, {})", build_id(),
                                                  build_compiler(), build_flags()));
    app.require_subcommand(1);
    app.footer(
        "Exit codes: 0 done, 1 some tasks failed, a scene has warnings, stores differ or a "
        "self-test\n"
        "does not pass, 2 usage, experiment or scene, 3 store, 4 coordinator out of reach, 70 a "
        "bug\n"
        "of misbench, 130 interrupted.");
    Chosen chosen;
    add_render_verbs(app, chosen);
    add_experiment_verbs(app, chosen, command_line_of(argc, argv));
    add_result_verbs(app, chosen);
    add_store_verbs(app, chosen);
    require_known_verb(app, argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);
        print_error(std::string(e.what()) + "; see misbench --help");
        return kExitUsage;
    }
    return chosen();
}

}  // namespace
}  // namespace misbench

int main(int argc, char** argv) {
    try {
        return misbench::run_program(argc, argv);
    } catch (const misbench::Error& e) {
        misbench::print_error(e.what());
        return misbench::exit_code(e.code());
    } catch (const std::bad_alloc&) {
        misbench::print_error("out of memory: a smaller image or scene is needed");
        return misbench::exit_code(misbench::Errc::FailedPrecondition);
    } catch (const std::exception& e) {
        misbench::print_error(std::string("unexpected: ") + e.what());
        return misbench::exit_code(misbench::Errc::Internal);
    }
}
