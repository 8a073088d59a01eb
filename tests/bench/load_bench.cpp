// How long a mesh of a million triangles takes from its file to a scene: the readers, the whole
// import, and the scene's own tables with and without Embree's part. On one thread.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "renderer/embree/accelerator.h"
#include "renderer/scene/load.h"
#include "renderer/scene/obj.h"
#include "renderer/scene/ply.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/seesharp.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// A wavy square of 2 · 708² triangles.
constexpr std::uint32_t kSide = 708;

Mesh make_mesh() {
    Mesh mesh;
    for (std::uint32_t y = 0; y <= kSide; ++y) {
        for (std::uint32_t x = 0; x <= kSide; ++x) {
            const float u = static_cast<float>(x) / kSide;
            const float v = static_cast<float>(y) / kSide;
            mesh.positions.push_back({u, 0.1F * std::sin(20 * u) * std::cos(17 * v), v});
            mesh.normals.push_back(normalized({-std::cos(20 * u), 1, std::sin(17 * v)}));
            mesh.uvs.push_back({u, v});
        }
    }
    for (std::uint32_t y = 0; y < kSide; ++y) {
        for (std::uint32_t x = 0; x < kSide; ++x) {
            const std::uint32_t at = y * (kSide + 1) + x;
            mesh.triangles.push_back({at, at + kSide + 1, at + 1});
            mesh.triangles.push_back({at + 1, at + kSide + 1, at + kSide + 2});
        }
    }
    return mesh;
}

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(sizeof(T), '\0');
    std::memcpy(bytes.data() + bytes.size() - sizeof(T), &value, sizeof(T));
}

std::string ply_header(const Mesh& mesh, const std::string& format) {
    std::string header = "ply\nformat " + format + " 1.0\nelement vertex " +
                         std::to_string(mesh.positions.size()) + "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "u", "v"}) {
        header += std::string("property float ") + name + "\n";
    }
    return header + "element face " + std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string binary_ply(const Mesh& mesh) {
    std::string bytes = ply_header(mesh, "binary_little_endian");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        append(bytes, mesh.positions[i]);
        append(bytes, mesh.normals[i]);
        append(bytes, mesh.uvs[i]);
    }
    for (const TriangleIndices& triangle : mesh.triangles) {
        bytes += '\3';
        append(bytes, triangle);
    }
    return bytes;
}

std::string text(std::initializer_list<float> numbers) {
    std::string line;
    for (const float number : numbers) line += " " + std::to_string(number);
    return line + "\n";
}

std::string ascii_ply(const Mesh& mesh) {
    std::string bytes = ply_header(mesh, "ascii");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 p = mesh.positions[i];
        const Vec3 n = mesh.normals[i];
        bytes += text({p.x, p.y, p.z, n.x, n.y, n.z, mesh.uvs[i].x, mesh.uvs[i].y});
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        bytes +=
            "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    }
    return bytes;
}

std::string obj(const Mesh& mesh) {
    std::string bytes = "usemtl m\n";
    for (const Vec3 p : mesh.positions) bytes += "v" + text({p.x, p.y, p.z});
    for (const Vec2 uv : mesh.uvs) bytes += "vt" + text({uv.x, uv.y});
    for (const Vec3 n : mesh.normals) bytes += "vn" + text({n.x, n.y, n.z});
    for (const TriangleIndices& triangle : mesh.triangles) {
        bytes += "f";
        for (const std::uint32_t corner : triangle) {
            const std::string index = std::to_string(corner + 1);
            bytes += " " + index + "/" + index + "/" + index;
        }
        bytes += "\n";
    }
    return bytes;
}

std::string scene_json(const std::string& type, const std::string& mesh_file) {
    return R"({"transforms": [{"name": "c", "position": [0.5, 3, 0.5], "rotation": [-90, 0, 0]}],
        "cameras": [{"name": "c", "type": "perspective", "fov": 30, "transform": "c"}],
        "materials": [{"name": "m", "type": "diffuse",
                       "baseColor": {"type": "rgb", "value": [0.5, 0.5, 0.5]}}],
        "objects": [{"name": "o", "type": ")" +
           type + R"(", "relativePath": ")" + mesh_file + R"(", "material": "m"}]})";
}

// The files of this benchmark, for the life of the process.
class Files {
 public:
    Files() {
        fs::create_directories(folder_);
        const Mesh mesh = make_mesh();
        write("binary.ply", binary_ply(mesh));
        write("ascii.ply", ascii_ply(mesh));
        write("mesh.obj", obj(mesh));
        write("ply.json", scene_json("ply", "binary.ply"));
        write("obj.json", scene_json("obj", "mesh.obj"));
    }
    ~Files() { fs::remove_all(folder_); }
    Files(const Files&) = delete;
    Files& operator=(const Files&) = delete;
    fs::path operator/(const std::string& name) const { return folder_ / name; }

 private:
    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
    }
    fs::path folder_ =
        fs::temp_directory_path() / ("misbench_load_bench_" + std::to_string(::getpid()));
};

const Files& files() {
    static const Files files;
    return files;
}

void read_ply_file(benchmark::State& state, const std::string& name) {
    const fs::path file = files() / name;
    for (auto _ : state) benchmark::DoNotOptimize(read_ply(file));
}

void read_obj_file(benchmark::State& state) {
    const fs::path file = files() / "mesh.obj";
    for (auto _ : state) benchmark::DoNotOptimize(read_obj(file));
}

void import_scene(benchmark::State& state, const std::string& name) {
    const fs::path file = files() / name;
    for (auto _ : state) benchmark::DoNotOptimize(import_seesharp(file));
}

void hash_scene(benchmark::State& state) {
    const fs::path file = files() / "ply.json";
    for (auto _ : state) benchmark::DoNotOptimize(scene_content_hash(file));
}

// The scene's tables and Embree's hierarchy; the next one is Embree's part alone.
void build_scene(benchmark::State& state) {
    const SceneDescription description = import_seesharp(files() / "ply.json");
    for (auto _ : state) {
        state.PauseTiming();
        SceneDescription copy = description;
        state.ResumeTiming();
        benchmark::DoNotOptimize(Scene(std::move(copy), 1));
    }
}

void build_hierarchy(benchmark::State& state) {
    const Scene scene(import_seesharp(files() / "ply.json"), 1);
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            Accelerator(scene.vertices(), scene.triangles(), scene.quadrics(), 1));
    }
}

BENCHMARK_CAPTURE(read_ply_file, binary, "binary.ply")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_ply_file, ascii, "ascii.ply")->Unit(benchmark::kMillisecond);
BENCHMARK(read_obj_file)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(import_scene, binary_ply, "ply.json")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(import_scene, obj, "obj.json")->Unit(benchmark::kMillisecond);
BENCHMARK(hash_scene)->Unit(benchmark::kMillisecond);
BENCHMARK(build_scene)->Unit(benchmark::kMillisecond);
BENCHMARK(build_hierarchy)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace misbench
