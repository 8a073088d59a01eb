#include "tests/fuzz/targets.h"

#include <zlib.h>

#include <algorithm>
#include <array>

#include "renderer/base/check.h"
#include "renderer/base/error.h"
#include "renderer/image/image.h"
#include "renderer/scene/mitsuba/import.h"
#include "renderer/scene/obj.h"
#include "renderer/scene/ply.h"
#include "renderer/scene/seesharp.h"
#include "renderer/scene/serialized.h"
#include "tests/support/temporary_folder.h"

namespace misbench::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
    "0 0 0 1 0 0 0 1 0 3 0 1 2\n";
constexpr std::string_view kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

// Where inputs are written, beside the files that the scenes of the corpus refer to.
class InputFolder {
 public:
    InputFolder() {
        Image grey(2, 2);
        std::fill(grey.rgb.begin(), grey.rgb.end(), 0.5F);
        folder_.write("m.ply", kPly);
        folder_.write("m.obj", kObj);
        folder_.write("t.png", encode_png(grey, 0));
        write_exr(folder_.path() / "e.exr", grey);
    }
    fs::path write(const std::string& name, std::span<const std::byte> input) const {
        // A new file is fast; one that is cut and written again waits for the disk.
        fs::remove(folder_.path() / name);
        return folder_.write(name, {reinterpret_cast<const char*>(input.data()), input.size()});
    }

 private:
    TemporaryFolder folder_;
};

// Gives the input as a file to a reader, which may refuse it.
void read_as(const std::string& name, std::span<const std::byte> input, auto read) {
    static const InputFolder folder;
    const fs::path file = folder.write(name, input);
    try {
        read(file);
    } catch (const Error&) {
    }
}

void check(const Mesh& mesh) {
    const std::size_t n = mesh.positions.size();
    MISBENCH_CHECK(mesh.normals.empty() || mesh.normals.size() == n);
    MISBENCH_CHECK(mesh.uvs.empty() || mesh.uvs.size() == n);
    for (const TriangleIndices& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) MISBENCH_CHECK(corner < n);
    }
}

void check(const SceneDescription& scene) {
    for (const Mesh& mesh : scene.meshes) {
        check(mesh);
        MISBENCH_CHECK(mesh.material < scene.materials.size());
        for (const Vec3 p : mesh.positions)
            MISBENCH_CHECK(std::isfinite(p.x + p.y + p.z) || max_abs(p) > 1e37F);
    }
    const auto n_textures = static_cast<std::int32_t>(scene.textures.size());
    for (const SurfaceMaterial& material : scene.materials) {
        MISBENCH_CHECK(material.front.layer.color_texture < n_textures);
        MISBENCH_CHECK(material.front.layer.roughness_texture < n_textures);
    }
}

void fuzz_json(std::span<const std::byte> input) {
    read_as("s.json", input, [](const fs::path& file) {
        static_cast<void>(seesharp_references(file));
        check(import_seesharp(file));
    });
}

void fuzz_xml(std::span<const std::byte> input) {
    read_as("s.xml", input, [](const fs::path& file) {
        static_cast<void>(mitsuba_references(file));
        check(import_mitsuba(file));
    });
}

void fuzz_ply(std::span<const std::byte> input) {
    read_as("i.ply", input, [](const fs::path& file) { check(read_ply(file)); });
}

void fuzz_obj(std::span<const std::byte> input) {
    read_as("i.obj", input, [](const fs::path& file) {
        for (const ObjPart& part : read_obj(file)) check(part.mesh);
    });
}

// A file with the input as the one mesh that it compresses: the fuzzer does not learn to compress.
std::string compressed(std::span<const std::byte> input) {
    std::string file("\x1C\x04\x04\x00", 4);  // magic number, version
    uLongf size = compressBound(input.size());
    file.resize(4 + size);
    compress(reinterpret_cast<Bytef*>(file.data() + 4), &size,
             reinterpret_cast<const Bytef*>(input.data()), input.size());
    file.resize(4 + size);
    return file + std::string("\0\0\0\0\0\0\0\0\1\0\0\0", 12);  // offset, number of meshes
}

void fuzz_serialized(std::span<const std::byte> input) {
    const std::string file = compressed(input);
    for (const auto bytes : {input, std::as_bytes(std::span(file))}) {
        read_as("i.serialized", bytes, [](const fs::path& path) {
            for (const std::size_t index : {0U, 1U}) check(read_serialized(path, index));
        });
    }
}

void fuzz_exr(std::span<const std::byte> input) {
    read_as("i.exr", input, [](const fs::path& file) {
        const Image image = read_exr(file);
        MISBENCH_CHECK(image.width > 0 && image.height > 0);
    });
}

constexpr std::array kTargets{
    Target{"json", fuzz_json},
    Target{"xml", fuzz_xml},
    Target{"ply", fuzz_ply},
    Target{"obj", fuzz_obj},
    Target{"serialized", fuzz_serialized},
    Target{"exr", fuzz_exr},
};

}  // namespace

std::span<const Target> targets() { return kTargets; }

}  // namespace misbench::fuzz
