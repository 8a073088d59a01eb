#include "experiments/report/report_images.h"

#include <fmt/format.h>

#include <map>
#include <optional>

#include "experiments/analysis/cell_images.h"
#include "experiments/report/numbers.h"
#include "renderer/base/base64.h"
#include "renderer/base/error.h"

namespace misbench {
namespace {

std::string effort_of(const RenderStatistics& run) {
    return fmt::format("{} spp in {:.3g} s cpu, {:.3g} s wall", run.passes, run.cpu_seconds,
                       run.wall_seconds);
}

class Collector {
 public:
    Collector(const Store& store, const Plan& plan, const Comparison& comparison, SeedImages seeds,
              Precision precision)
        : store_(store),
          plan_(plan),
          comparison_(comparison),
          seeds_(seeds),
          precision_(precision) {}

    ReportImages collect() {
        for (std::size_t s = 0; s < plan_.scenes.size(); ++s) {
            add_reference(s);
            for (std::size_t b = 0; b < plan_.budgets.size(); ++b) {
                for (std::size_t m = 0; m < plan_.methods.size(); ++m) add_cell(s, b, m);
            }
        }
        return std::move(found_);
    }

 private:
    std::size_t add_block(const Image& image) {
        const PixelBlock block = pack_pixels(image, precision_);
        const std::size_t number = found_.blocks.size();
        found_.blocks.push_back({{"width", image.width},
                                 {"height", image.height},
                                 {"precision", to_string(block.precision)},
                                 {"scale", block.scale}});
        found_.html += fmt::format("<script type=\"text/plain\" id=\"block-{}\">", number);
        found_.html += base64(block.bytes);
        found_.html += "</script>\n";
        return number;
    }

    // Cells may share a run, and the mean of a single one is its image.
    std::size_t block_of(const std::string& run) {
        const auto known = blocks_.find(run);
        if (known != blocks_.end()) return known->second;
        return blocks_[run] = add_block(store_.run_image(run));
    }

    void add_reference(std::size_t scene) {
        const auto images = reference_images(store_, plan_, plan_.scenes[scene].name);
        if (!images) return;
        std::string caption = "reference";
        for (const Cell& cell : plan_.cells) {
            if (cell.scene != plan_.scenes[scene].name || cell.role != Role::ReferenceA) continue;
            caption = fmt::format("reference: {}, mean of 2 × {}", cell.task.method,
                                  to_string(cell.budget));
        }
        found_.images.push_back({{"scene", scene},
                                 {"method", nullptr},
                                 {"budget", nullptr},
                                 {"seed", nullptr},
                                 {"caption", caption},
                                 {"block", add_block(images->mean)}});
    }

    void add_image(std::size_t scene, std::size_t budget, std::size_t method,
                   const nlohmann::ordered_json& seed, const std::string& caption,
                   std::size_t block) {
        found_.images.push_back(
            {{"scene", scene},
             {"method", method},
             {"budget", budget},
             {"seed", seed},
             {"caption", fmt::format("{}, {}, {}", plan_.methods[method],
                                     to_string(plan_.budgets[budget]), caption)},
             {"block", block}});
    }

    void add_cell(std::size_t s, std::size_t b, std::size_t m) {
        const std::string& scene = plan_.scenes[s].name;
        const std::string& method = plan_.methods[m];
        const Budget& budget = plan_.budgets[b];
        const ComparedCell* compared = comparison_.find(scene, method, budget);
        const std::vector<CellRun> runs = finished_runs(store_, plan_, scene, method, budget);
        if (!runs.empty()) {
            const std::size_t block =
                runs.size() == 1 ? block_of(runs[0].run) : add_block(*mean_image(store_, runs));
            add_image(s, b, m, "mean", caption_of_mean(runs.size(), compared), block);
        }
        if (seeds_ == SeedImages::None) return;
        for (const Cell& cell : plan_.cells) {
            if (cell.role != Role::Test || cell.scene != scene || cell.method != method ||
                cell.budget != budget) {
                continue;
            }
            const std::optional<Record> record = store_.run(task_id(cell.task));
            if (!record) continue;
            add_image(s, b, m, cell.seed, caption_of_seed(cell, *record, compared),
                      block_of(record->run));
            if (seeds_ == SeedImages::First) return;
        }
    }

    std::string caption_of_mean(std::size_t n_runs, const ComparedCell* cell) const {
        std::string caption = fmt::format("mean of {} seed{}", n_runs, n_runs == 1 ? "" : "s");
        if (cell == nullptr || !cell->mean) return caption;
        caption += fmt::format("; a seed's {} {}", comparison_.metric, format_mean(*cell->mean));
        if (cell->ratio) caption += ", " + format_ratio(*cell->ratio);
        if (cell->few_passes) caption += "; FEW PASSES";
        return caption;
    }

    std::string caption_of_seed(const Cell& cell, const Record& record,
                                const ComparedCell* compared) const {
        std::string caption = fmt::format("seed {}: {}", cell.seed, effort_of(record.statistics));
        for (std::size_t i = 0; compared != nullptr && i < compared->seeds.size(); ++i) {
            if (compared->seeds[i] != cell.seed) continue;
            caption += fmt::format("; {} {:.4g}", comparison_.metric, compared->values[i]);
        }
        if (has_few_passes(cell.budget, record.statistics.passes)) caption += "; FEW PASSES";
        if (!record.valid) caption += "; INVALID run";
        return caption;
    }

    const Store& store_;
    const Plan& plan_;
    const Comparison& comparison_;
    SeedImages seeds_;
    Precision precision_;
    ReportImages found_;
    std::map<std::string, std::size_t> blocks_;  // by run
};

}  // namespace

SeedImages seed_images_from_string(const std::string& text) {
    if (text == "none") return SeedImages::None;
    if (text == "first") return SeedImages::First;
    if (text == "all") return SeedImages::All;
    throw Error(Errc::InvalidArgument,
                "unknown choice of seeds '" + text + "'; known: none first all");
}

ReportImages collect_images(const Store& store, const Plan& plan, const Comparison& comparison,
                            SeedImages seeds, Precision precision) {
    return Collector(store, plan, comparison, seeds, precision).collect();
}

}  // namespace misbench
