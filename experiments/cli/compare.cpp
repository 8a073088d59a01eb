// misbench compare: images against a reference by metrics, without a store.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/cli/image_file.h"
#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/table_formats.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "results/metrics/error_parts.h"
#include "results/metrics/metrics.h"

namespace misbench {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

constexpr const char* kDefaultMetrics[] = {
    "relmse.eps0.01", "relmse.eps0.01.trim0.001",     "mse", "smape.eps0.01", "flip.ldr.ppd67",
    "flip.hdr.ppd67", "luminance.rec709.bias.eps1e-9"};

struct ComparedImage {
    std::string name;
    std::vector<double> values;                 // one a metric
    std::vector<std::optional<double>> ratios;  // to the first image's, where that means something
    // Of the error against the reference, where the metric is a squared error and there are halves.
    std::vector<std::optional<double>> noise_shares;
};

struct ImageComparison {
    std::vector<const Metric*> metrics;
    std::vector<ComparedImage> images;
    bool is_naive = false;
    std::vector<std::string> notes;
};

std::vector<const Metric*> metrics_of(const CompareOptions& options) {
    std::vector<const Metric*> chosen;
    if (options.metrics.empty()) {
        for (const char* id : kDefaultMetrics) chosen.push_back(&find_metric(id));
    }
    for (const std::string& id : options.metrics) chosen.push_back(&find_metric(id));
    return chosen;
}

// The image of a file. What had to be assumed of it becomes a note.
Image read_noting(const std::string& file, const CompareOptions& options,
                  ImageComparison& comparison) {
    ImageFile read = read_image_file(file, options.layer);
    if (!read.assumption.empty()) comparison.notes.push_back(file + ": " + read.assumption);
    return std::move(read.image);
}

void require_size_of_reference(const std::string& file, const Image& image,
                               const CompareOptions& options, const Image& reference) {
    if (image.width == reference.width && image.height == reference.height) return;
    throw Error(
        Errc::InvalidArgument,
        fmt::format("image '{}': it is {}x{}, and the reference '{}' {}x{}", file, image.width,
                    image.height, options.reference, reference.width, reference.height));
}

// Of an error; a ratio of luminances or shares says nothing.
bool may_have_ratios(const Metric& metric) {
    return metric.across_scenes == AcrossScenes::GeometricMeanOfRatios;
}

ComparedImage compare_image(const std::string& file, const Image& image,
                            const ReferencePair& reference, const ImageComparison& comparison) {
    ComparedImage compared{.name = file, .values = {}, .ratios = {}, .noise_shares = {}};
    for (std::size_t m = 0; m < comparison.metrics.size(); ++m) {
        const Metric& metric = *comparison.metrics[m];
        const double value = measure(metric, image, reference);
        compared.values.push_back(value);
        compared.ratios.emplace_back();
        compared.noise_shares.emplace_back();
        if (!comparison.is_naive && metric.denominator != nullptr) {
            compared.noise_shares[m] =
                reference_noise_share(value, reference_noise(metric, reference));
        }
        if (comparison.images.empty()) continue;
        const double first = comparison.images.front().values[m];
        if (may_have_ratios(metric) && first > 0) {
            compared.ratios[m] = value / first;
        }
    }
    return compared;
}

void write_map(const CompareOptions& options, const Metric& metric, const Image& image,
               const ReferencePair& reference) {
    const std::vector<double> values = measure_map(metric, image, reference);
    Image map(image.width, image.height);
    for (std::size_t i = 0; i < map.rgb.size(); ++i) {
        map.rgb[i] = static_cast<float>(values[i / 3]);
    }
    const std::filesystem::path output = options.map;
    if (output.extension() == ".exr") {
        write_exr(output, map, {{"misbench.metric", std::string(metric.id)}});
    } else {
        write_file_durably(output, encode_png(map, 0));
    }
    print_note(fmt::format("wrote {}: {} of {}{}", options.map, metric.id, options.images.front(),
                           output.extension() == ".exr" ? "" : ", 0 black, 1 white"));
}

void require_one_map(const CompareOptions& options) {
    if (options.map.empty()) return;
    require_extension(options.map, {".exr", ".png"});
    if (options.images.size() != 1 || options.metrics.size() != 1) {
        throw Error(
            Errc::InvalidArgument,
            fmt::format("write '{}': a map is of one image by one --metric, not of {} by {}",
                        options.map, options.images.size(), options.metrics.size()));
    }
}

void note_reference(const CompareOptions& options, ImageComparison& comparison) {
    std::vector<std::string>& notes = comparison.notes;
    if (!comparison.is_naive) {
        notes.push_back(fmt::format("reference: {} and {}, whose noise cancels in squared errors",
                                    options.reference, options.reference_b));
    } else if (options.reference_b.empty()) {
        notes.push_back(
            fmt::format("reference: {}, one image, so its noise is in the numbers "
                        "(naive); an independent --reference-b takes it out",
                        options.reference));
    } else {
        notes.push_back(
            fmt::format("reference: {} and {} are the same image, so its noise is in "
                        "the numbers (naive)",
                        options.reference, options.reference_b));
    }
}

void note_noisy_reference(ImageComparison& comparison) {
    for (const ComparedImage& image : comparison.images) {
        for (std::size_t m = 0; m < comparison.metrics.size(); ++m) {
            const auto share = image.noise_shares[m];
            if (!share || *share <= kMaxReferenceNoiseShare) continue;
            comparison.notes.push_back(
                fmt::format("noisy reference: {:.2g} % of {}'s {} against it would be its noise",
                            100 * *share, image.name, comparison.metrics[m]->id));
        }
    }
}

bool has_ratios(const ComparedImage& image) {
    for (const auto& ratio : image.ratios) {
        if (ratio) return true;
    }
    return false;
}

// The header, and under each image's line its ratios.
Rows rows_of(const ImageComparison& comparison) {
    Rows rows{{"image"}};
    for (const Metric* metric : comparison.metrics) rows[0].emplace_back(metric->id);
    for (const ComparedImage& image : comparison.images) {
        rows.push_back({image.name});
        for (const double value : image.values) rows.back().push_back(fmt::format("{:.4g}", value));
        if (!has_ratios(image)) continue;
        rows.push_back({""});
        for (const auto& ratio : image.ratios) {
            rows.back().push_back(ratio ? fmt::format("×{:.3g}", *ratio) : "");
        }
    }
    return rows;
}

std::string to_text(const ImageComparison& comparison) {
    std::string text = align(rows_of(comparison)) + "\n";
    for (const std::string& note : comparison.notes) text += note + "\n";
    return text;
}

std::string to_markdown(const ImageComparison& comparison) {
    const Rows rows = rows_of(comparison);
    std::string text;
    for (const auto& row : rows) {
        text += "|";
        for (const std::string& cell : row) text += " " + escape_markdown(cell) + " |";
        text += "\n";
        if (&row != &rows.front()) continue;
        text += "|---|";
        for (std::size_t m = 0; m < comparison.metrics.size(); ++m) text += "---:|";
        text += "\n";
    }
    text += "\n";
    for (const std::string& note : comparison.notes) text += escape_markdown(note) + "  \n";
    return text;
}

// Ratios are columns, so that every row is an image.
std::string to_csv(const ImageComparison& comparison) {
    const std::vector<const Metric*>& metrics = comparison.metrics;
    std::string text = "image";
    for (const Metric* metric : metrics) text.append(",").append(metric->id);
    for (const Metric* metric : metrics) {
        if (may_have_ratios(*metric)) text.append(",ratio.").append(metric->id);
    }
    text += ",naive\n";
    for (const ComparedImage& image : comparison.images) {
        text += escape_csv(image.name);
        for (const double value : image.values) text += fmt::format(",{}", value);
        for (std::size_t m = 0; m < metrics.size(); ++m) {
            const auto ratio = image.ratios[m];
            if (may_have_ratios(*metrics[m])) text += ratio ? fmt::format(",{}", *ratio) : ",";
        }
        text += comparison.is_naive ? ",1\n" : ",0\n";
    }
    return text;
}

std::string to_json(const CompareOptions& options, const ImageComparison& comparison) {
    Json json{{"reference", options.reference},
              {"reference_b", options.reference_b.empty() ? Json() : Json(options.reference_b)},
              {"naive", comparison.is_naive},
              {"notes", comparison.notes},
              {"images", Json::array()}};
    for (const ComparedImage& image : comparison.images) {
        Json entry{{"image", image.name}, {"metrics", Json::object()}};
        for (std::size_t m = 0; m < comparison.metrics.size(); ++m) {
            const std::string id(comparison.metrics[m]->id);
            entry["metrics"][id] = image.values[m];
            if (image.ratios[m]) entry["ratios"][id] = *image.ratios[m];
            if (image.noise_shares[m]) entry["reference_noise_shares"][id] = *image.noise_shares[m];
        }
        json["images"].push_back(std::move(entry));
    }
    return json.dump(2) + "\n";
}

std::string formatted(const CompareOptions& options, const ImageComparison& comparison) {
    if (options.format == "csv") return to_csv(comparison);
    if (options.format == "json") return to_json(options, comparison);
    if (options.format == "markdown") return to_markdown(comparison);
    return to_text(comparison);
}

}  // namespace

int compare_verb(const CompareOptions& options) {
    require_one_map(options);
    ImageComparison comparison;
    comparison.metrics = metrics_of(options);
    const Image a = read_noting(options.reference, options, comparison);
    const Image b =
        options.reference_b.empty() ? a : read_noting(options.reference_b, options, comparison);
    if (!options.reference_b.empty()) {
        require_size_of_reference(options.reference_b, b, options, a);
    }
    comparison.is_naive = a == b;
    note_reference(options, comparison);
    for (const std::string& file : options.images) {
        const Image image = read_noting(file, options, comparison);
        require_size_of_reference(file, image, options, a);
        comparison.images.push_back(compare_image(file, image, {a, b}, comparison));
        if (!options.map.empty()) write_map(options, *comparison.metrics.front(), image, {a, b});
    }
    note_noisy_reference(comparison);
    print_result(formatted(options, comparison));
    return 0;
}

}  // namespace misbench
