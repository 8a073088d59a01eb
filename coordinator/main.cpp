// misbench-coordinator: gives out a store's tasks and keeps their results.
#include <CLI/CLI.hpp>

#include "coordinator/rpc/service.h"
#include "proto/address.h"
#include "proto/daemon.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/base/log.h"

namespace misbench {
namespace {

struct Options {
    std::string store;
    std::string listen = "127.0.0.1:0";
    std::string address_file;
    std::int64_t lease_seconds = 15;
    std::string log_level = "info";
    bool allow_remote = false;
    bool with_parent = false;
};

void declare(CLI::App& app, Options& options) {
    app.add_option("--store", options.store, "the store's directory; made if it is not there")
        ->required();
    app.add_option("--listen", options.listen, "unix:/path or host:port; port 0 takes a free one")
        ->capture_default_str();
    app.add_option("--address-file", options.address_file,
                   "written, with the real port, once workers can connect");
    app.add_option("--lease-seconds", options.lease_seconds,
                   "a worker that is silent for so long has lost its task")
        ->check(CLI::Range(1, 86'400))
        ->capture_default_str();
    app.add_flag("--allow-remote", options.allow_remote,
                 "listen beyond this machine; there is no authentication yet, so whoever reaches "
                 "the port can take tasks and store results");
    app.add_flag("--exit-with-parent", options.with_parent,
                 "die with the process that started this one");
    app.add_option("--log-level", options.log_level, "debug info warning error critical off")
        ->capture_default_str();
}

void serve(const Options& options) {
    if (options.with_parent) exit_with_parent();
    init_log("misbench-coordinator", options.log_level);
    check_address("listen on", options.listen);
    if (!options.allow_remote && !is_local_address(options.listen)) {
        throw Error(Errc::InvalidArgument,
                    "listen on '" + options.listen +
                        "': not an address of this machine alone; --allow-remote permits it");
    }
    const StopSignals stop;
    TaskQueue queue(Store(options.store, Store::Access::ReadWrite),
                    {.ttl = std::chrono::seconds(options.lease_seconds)},
                    std::chrono::steady_clock::now());
    const QueueServer server(queue, options.listen);
    if (!options.address_file.empty()) write_file_durably(options.address_file, server.address());
    spdlog::info("coordinator started address={} store={}", server.address(), options.store);
    stop.wait();
    spdlog::info("coordinator stopped");
}

}  // namespace
}  // namespace misbench

int main(int argc, char** argv) {
    misbench::Options options;
    CLI::App app("Gives out the tasks of a store to workers and keeps their results.",
                 "misbench-coordinator");
    misbench::declare(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    }
    return misbench::run_daemon("misbench-coordinator", [&] { misbench::serve(options); });
}
