// write_extremes FOLDER: the extreme scenes as SeeSharp files, FOLDER/NAME/NAME.json with a binary
// PLY for each mesh. Floats keep their bits. Scenes that the format cannot say are named and left
// out.
#include <bit>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/extremes/extreme_scenes.h"
#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench::extremes {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

template <class T>
void append(std::string& bytes, const T& value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    bytes.append(raw.data(), raw.size());
}

std::string ply_bytes(const Mesh& mesh) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                        std::to_string(mesh.positions.size()) +
                        "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                        std::to_string(mesh.triangles.size()) +
                        "\nproperty list uchar uint vertex_indices\nend_header\n";
    for (const Vec3& position : mesh.positions) append(bytes, position);
    for (const TriangleIndices& triangle : mesh.triangles) {
        append(bytes, std::uint8_t{3});
        append(bytes, triangle);
    }
    return bytes;
}

json rgb_to_json(Rgb c) { return {{"type", "rgb"}, {"value", {c.r, c.g, c.b}}}; }

// Row-vector matrix: the columns of ours are its rows.
json matrix_to_json(const Transform& transform) {
    json matrix = json::array();
    for (std::size_t column = 0; column < 4; ++column) {
        for (const auto& row : transform.rows) matrix.push_back(row[column]);
        matrix.push_back(column == 3 ? 1 : 0);
    }
    return matrix;
}

bool is_seesharp(const SceneDescription& scene) {
    const auto is_matte = [](const SurfaceMaterial& material) {
        return std::holds_alternative<DiffuseMaterial>(material.front.layer.material);
    };
    return !scene.environment &&
           std::all_of(scene.materials.begin(), scene.materials.end(), is_matte);
}

// REQUIRES: is_seesharp(scene), all meshes flat.
void write_scene(const fs::path& folder, const std::string& name, const SceneDescription& scene) {
    json root = {
        {"name", name},
        {"transforms", {{{"name", "camera"}, {"matrix", matrix_to_json(scene.camera.to_world)}}}},
        {"cameras",
         {{{"name", "default"},
           {"type", "perspective"},
           {"fov", scene.camera.fov_degrees},
           {"transform", "camera"}}}},
        {"materials", json::array()},
        {"objects", json::array()}};
    for (const SurfaceMaterial& material : scene.materials) {
        const auto& matte = std::get<DiffuseMaterial>(material.front.layer.material);
        root["materials"].push_back({{"name", material.name},
                                     {"type", "diffuse"},
                                     {"baseColor", rgb_to_json(matte.reflectance)}});
    }
    fs::create_directories(folder);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        const Mesh& mesh = scene.meshes[i];
        const std::string file = "mesh" + std::to_string(i) + ".ply";
        write_file_durably(folder / file, ply_bytes(mesh));
        json object = {{"type", "ply"},
                       {"relativePath", file},
                       {"material", scene.materials[mesh.material].name}};
        if (mesh.emission != Rgb{}) object["emission"] = rgb_to_json(mesh.emission);
        root["objects"].push_back(std::move(object));
    }
    write_file_durably(folder / (name + ".json"), root.dump(1) + "\n");
}

void write_all(const fs::path& folder) {
    for (const ExtremeScene& row : extreme_scenes()) {
        const std::string name(row.name);
        const SceneDescription scene = row.make();
        if (is_seesharp(scene)) {
            write_scene(folder / name, name, scene);
            std::printf("%s: %s\n", name.c_str(), std::string(row.extreme).c_str());
        } else {
            std::printf("%s: left out, SeeSharp's format has no such scene\n", name.c_str());
        }
    }
}

}  // namespace
}  // namespace misbench::extremes

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("write_extremes: expected one argument, the folder to write to\n", stderr);
        return 2;
    }
    try {
        misbench::extremes::write_all(argv[1]);
    } catch (const misbench::Error& e) {
        std::fprintf(stderr, "write_extremes: %s\n", e.what());
        return 1;
    }
}
