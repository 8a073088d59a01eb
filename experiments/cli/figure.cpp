// misbench figure: a figure of a paper, made anew from the store.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/figure/figure.h"
#include "experiments/figure/write.h"

namespace misbench {

int figure_verb(const FigureOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    figure::FigureFile file = figure::read_figure_file(options.file);
    const Store store(options.store, Store::Access::ReadOnly);
    std::string experiments;
    for (figure::Panel& panel : file.panels) {
        if (!options.experiment.empty()) panel.experiment = options.experiment;
        experiments += (experiments.empty() ? "" : ", ") + panel.experiment;
    }
    const figure::Typeface typeface = figure::choose_typeface();
    if (!figure::is_preferred(typeface)) {
        print_note("Linux Biolinum is not installed (package fonts-linuxlibertine): text is in " +
                   typeface.family);
    }
    const figure::Drawing drawing = figure::make_figure(store, file, typeface);
    const std::filesystem::path output = options.output;
    figure::write_figure(output, drawing, typeface,
                         {.title = output.stem(), .description = "Experiments: " + experiments});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    print_note(fmt::format("wrote {}: {:.1f} x {:.1f} pt in {:.2f} s", options.output,
                           drawing.width, drawing.height, seconds.count()));
    return 0;
}

}  // namespace misbench
