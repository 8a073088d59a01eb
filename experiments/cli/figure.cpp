// misbench figure: a figure of a paper, made anew from the store.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <set>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/figure/figure.h"
#include "experiments/figure/write.h"

namespace misbench {
namespace {

std::string description_of(const Store& store, const figure::FigureFile& file) {
    std::set<std::string> experiments;
    for (const figure::Panel& panel : file.panels) {
        if (std::holds_alternative<figure::MapsPanel>(panel.kind)) continue;
        experiments.insert(store.experiment_head(panel.experiment).experiment);
    }
    return experiments.empty() ? "" : fmt::format("Experiments: {}", fmt::join(experiments, ", "));
}

}  // namespace

int figure_verb(const FigureOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    const std::filesystem::path output = options.output;
    figure::require_format(output);
    figure::FigureFile file = figure::read_figure_file(options.file);
    const Store store(options.store, Store::Access::ReadOnly);
    if (!options.experiment.empty()) {
        for (figure::Panel& panel : file.panels) panel.experiment = options.experiment;
    }
    const figure::Typeface typeface = figure::choose_typeface();
    if (!figure::is_preferred(typeface)) {
        print_note("Linux Biolinum is not installed (package fonts-linuxlibertine): text is in " +
                   typeface.family);
    }
    const figure::Drawing drawing = figure::make_figure(store, file, typeface);
    figure::write_figure(output, drawing, typeface,
                         {.title = output.stem(), .description = description_of(store, file)});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    print_note(fmt::format("wrote {}: {:.1f} x {:.1f} pt in {:.2f} s", options.output,
                           drawing.width, drawing.height, seconds.count()));
    return 0;
}

}  // namespace misbench
