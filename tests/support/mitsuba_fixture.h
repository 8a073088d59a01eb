// Mitsuba scenes written and read by a test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "renderer/base/error.h"
#include "renderer/scene/mitsuba/import.h"

namespace misbench::test {

namespace fs = std::filesystem;

inline constexpr const char* kSensor =
    "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>";

// A square of four corners whose top edge has v = 1; normals are optional.
inline constexpr const char* kSquare =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

class Mitsuba : public testing::Test {
 protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("misbench_mitsuba_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
        write("flat.obj", std::string(kSquare) + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
        write("smooth.obj", std::string(kSquare) + "vn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n");
        write("rgb.tga", tga(24));
        write("rgba.tga", tga(32));
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }
    // One pixel, uncompressed.
    static std::string tga(char bits) {
        std::string bytes(18, '\0');
        bytes[2] = 2;
        bytes[12] = bytes[14] = 1;
        bytes[16] = bits;
        return bytes + std::string(static_cast<std::size_t>(bits) / 8, '\x40');
    }

    SceneDescription read_all(const std::string& body, const std::string& version = "3.0.0") const {
        return import_mitsuba(
            write("s.xml", "<scene version=\"" + version + "\">" + body + "</scene>"));
    }
    SceneDescription read(const std::string& body, const std::string& version = "3.0.0") const {
        return read_all(kSensor + body, version);
    }
    // A rectangle with that inside.
    SceneDescription rectangle(const std::string& inside,
                               const std::string& version = "3.0.0") const {
        return read("<shape type=\"rectangle\">" + inside + "</shape>", version);
    }
    SurfaceMaterial material(const std::string& bsdf, const std::string& version = "3.0.0") const {
        return rectangle(bsdf, version).materials.at(0);
    }
    PerspectiveCamera camera(const std::string& inside) const {
        return read_all("<sensor type=\"perspective\">" + inside + "</sensor>").camera;
    }
    template <class Read>
    static std::string message_of(Read&& read) {
        try {
            read();
        } catch (const Error& e) {
            return e.what();
        }
        return "no error";
    }
    std::string error_of(const std::string& body, const std::string& version = "3.0.0") const {
        return message_of([&] { read(body, version); });
    }
    std::string shape_error(const std::string& inside, const std::string& version = "3.0.0") const {
        return message_of([&] { rectangle(inside, version); });
    }

    fs::path folder_;
};

inline void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-5F) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}
inline void expect_near(Rgb a, Rgb b, float tolerance = 1e-5F) {
    expect_near(Vec3{a.r, a.g, a.b}, Vec3{b.r, b.g, b.b}, tolerance);
}

// By the winding of the first triangle.
inline Vec3 face_normal(const Mesh& mesh) {
    const auto [a, b, c] = mesh.triangles.at(0);
    return normalized(
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

inline std::string shape(const std::string& type, const std::string& inside) {
    return "<shape type=\"" + type + "\">" + inside + "</shape>";
}
inline std::string obj(const std::string& file, const std::string& inside = "") {
    return shape("obj", "<string name=\"filename\" value=\"" + file + "\"/>" + inside);
}
inline std::string to_world(const std::string& operations) {
    return "<transform name=\"to_world\">" + operations + "</transform>";
}

}  // namespace misbench::test
