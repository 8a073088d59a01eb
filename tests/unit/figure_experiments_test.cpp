// The repository's figures ask for what its experiments have.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "experiments/figure/query.h"
#include "experiments/resolve.h"
#include "tests/support/temporary_folder.h"

namespace misbench::figure {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> yaml_files(bool of_figures) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(MISBENCH_EXPERIMENTS)) {
        const fs::path& file = entry.path();
        const bool is_figure = file.parent_path().filename() == "figures";
        if (file.extension() == ".yaml" && is_figure == of_figures) files.push_back(file);
    }
    return files;
}

Plan plan_of(const std::string& experiment) {
    for (const fs::path& file : yaml_files(false)) {
        const YamlNode root = read_yaml_file(file);
        const YamlNode* name = root.find("name");
        if (name == nullptr || name->text != experiment) continue;
        return resolve(read_experiment_yaml(file), fs::path(MISBENCH_EXPERIMENTS) / "scenes");
    }
    ADD_FAILURE() << "no experiment " << experiment;
    return {};
}

TEST(FigureFiles, NameWhatTheirExperimentHas) {
    TemporaryFolder folder;
    Store store(folder.path() / "store", Store::Access::ReadWrite);
    int n_panels = 0;
    for (const fs::path& file : yaml_files(true)) {
        for (const Panel& panel : read_figure_file(file).panels) {
            const auto known = store.experiments();
            if (std::ranges::find(known, panel.experiment) == known.end()) {
                store.put_experiment(plan_of(panel.experiment));
            }
            const bool is_comparison = std::holds_alternative<ComparisonPanel>(panel.kind);
            EXPECT_NO_THROW(budget_of(ask(store, panel, is_comparison), panel)) << file;
            ++n_panels;
        }
    }
    EXPECT_GE(n_panels, 6);
}

}  // namespace
}  // namespace misbench::figure
