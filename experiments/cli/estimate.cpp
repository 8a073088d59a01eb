#include "experiments/cli/estimate.h"

#include "experiments/scene_lookup.h"
#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"

namespace misbench {
namespace {

constexpr int kMaxSide = 16'384;

// "640x480".
FrameInfo parse_size(const std::string& text) {
    const std::vector<YamlNode> sides = parse_pair("--size", text, 'x', "WIDTHxHEIGHT");
    return {.width = static_cast<int>(read_integer(sides[0], "width", 1, kMaxSide)),
            .height = static_cast<int>(read_integer(sides[1], "height", 1, kMaxSide))};
}

}  // namespace

ParameterMap parse_parameters(const std::vector<std::string>& assignments) {
    ParameterMap parameters;
    for (const std::string& assignment : assignments) {
        const auto equals = assignment.find('=');
        const std::string source = "--set " + assignment;
        if (equals == std::string::npos) {
            throw Error(Errc::InvalidArgument, source + ": must be KEY=VALUE");
        }
        const std::string key = assignment.substr(0, equals);
        const YamlNode value = parse_yaml(assignment.substr(equals + 1), source, false);
        parameters[key] = read_parameter(value, key);
    }
    return parameters;
}

std::vector<YamlNode> parse_pair(const std::string& option, const std::string& text, char separator,
                                 const std::string& form) {
    const std::string source = option + " " + text;
    const auto at = text.find(separator);
    const YamlNode pair = parse_yaml(
        at == std::string::npos ? "[]"
                                : "[" + text.substr(0, at) + ", " + text.substr(at + 1) + "]",
        source, false);
    if (pair.items.size() != 2) throw Error(Errc::InvalidArgument, source + ": must be " + form);
    return pair.items;
}

Estimate load_estimate(const EstimateOptions& options, const Budget& budget) {
    FrameInfo size;
    if (!options.size.empty()) size = parse_size(options.size);
    const MethodInfo& method = find_method(options.method);
    Task task{.scene_hash = {},
              .width = size.width,
              .height = size.height,
              .method = options.method,
              .method_version = method.version,
              .parameters = method.effective(parse_parameters(options.parameters)),
              .budget = budget,
              .seed = options.seed,
              .scene = {},
              .scene_file = {}};
    const SceneListing scene =
        find_scene(options.scene, std::filesystem::current_path(), scene_folder(options.scenes));
    task.scene = scene.name;
    task.scene_file = scene.file.string();
    task.scene_hash = scene_content_hash(scene.file);

    LoadedScene loaded = load_scene(scene.file, options.threads);
    if (options.size.empty()) {
        const FilmDefaults& film = loaded.scene->film();
        task.width = film.width > 0 ? film.width : 640;
        task.height = film.height > 0 ? film.height : 480;
    }
    return {.task = std::move(task), .loaded = std::move(loaded)};
}

RenderRequest request_of(const Task& task, int threads) {
    return {.method = task.method,
            .parameters = task.parameters,
            .width = task.width,
            .height = task.height,
            .budget = task.budget,
            .seed = task.seed,
            .threads = threads};
}

}  // namespace misbench
