// misbench: the syntax of the verbs that keep a store in order.
#include <memory>

#include "experiments/cli/arguments.h"
#include "experiments/cli/verbs.h"

namespace misbench {
namespace {

void add_store_verb(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& help,
                    int (*function)(const StoreOptions&)) {
    const auto options = std::make_shared<StoreOptions>();
    CLI::App& verb = add_verb(app, name, help, function, options, chosen);
    verb.add_option("store", options->store, "results store")->required();
}

}  // namespace

void add_store_verbs(CLI::App& app, Chosen& chosen) {
    add_store_verb(app, chosen, "status", "count the tasks of a store's experiments", status_verb);
    add_store_verb(app, chosen, "reindex", "rebuild a store's database from its run directories",
                   reindex_verb);
}

}  // namespace misbench
