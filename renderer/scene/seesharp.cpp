#include "renderer/scene/seesharp.h"

#include <map>
#include <nlohmann/json.hpp>

#include "renderer/base/error.h"
#include "renderer/base/files.h"
#include "renderer/scene/obj.h"
#include "renderer/scene/ply.h"

namespace misbench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// A JSON value with the place it stands at, so that every error names it.
class Node {
 public:
    Node(const json* value, std::string file, std::string place)
        : value_(value), file_(std::move(file)), place_(std::move(place)) {}

    [[noreturn]] void fail(const std::string& reason) const {
        throw Error(Errc::InvalidArgument,
                    "scene '" + file_ + "': " + (place_.empty() ? "" : place_ + ": ") + reason);
    }

    bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
    Node operator[](const char* key) const {
        if (!has(key)) fail(std::string("missing '") + key + "'");
        return {&(*value_)[key], file_, place_.empty() ? key : place_ + "." + key};
    }
    // The elements of an array; none when the key is missing.
    std::vector<Node> list(const char* key) const {
        if (!has(key)) return {};
        const Node array = (*this)[key];
        if (!array.value_->is_array()) array.fail("expected an array");
        std::vector<Node> nodes;
        for (std::size_t i = 0; i < array.value_->size(); ++i) {
            nodes.emplace_back(&(*array.value_)[i], file_,
                               array.place_ + "[" + std::to_string(i) + "]");
        }
        return nodes;
    }

    template <class T>
    T as() const {
        try {
            return value_->get<T>();
        } catch (const json::exception&) {
            fail("unexpected value " + value_->dump().substr(0, 60));
        }
    }
    template <class T>
    T value_or(const char* key, T fallback) const {
        return has(key) ? (*this)[key].as<T>() : fallback;
    }
    bool is_string() const { return value_->is_string(); }

    // A number that is finite and, unless said otherwise, not negative.
    float number_or(const char* key, float fallback) const {
        const auto value = value_or<float>(key, fallback);
        if (!std::isfinite(value)) (*this)[key].fail("is not finite");
        return value;
    }
    float fraction_or(const char* key, float fallback) const {
        const float value = number_or(key, fallback);
        if (value < 0 || value > 1) (*this)[key].fail("is not between 0 and 1");
        return value;
    }
    std::vector<float> floats(std::size_t multiple_of) const {
        auto values = as<std::vector<float>>();
        if (values.size() % multiple_of != 0) {
            fail("expected a multiple of " + std::to_string(multiple_of) + " numbers, found " +
                 std::to_string(values.size()));
        }
        return values;
    }
    Vec3 vec3_or(const char* key, Vec3 fallback) const {
        if (!has(key)) return fallback;
        const auto v = (*this)[key].as<std::array<float, 3>>();
        return {v[0], v[1], v[2]};
    }
    // {"type": "rgb", "value": [r, g, b]}; the type may be left out.
    Rgb rgb() const {
        if (value_or<std::string>("type", "rgb") != "rgb") {
            fail("colours of type '" + (*this)["type"].as<std::string>() +
                 "' are not supported; known: rgb");
        }
        const auto v = (*this)["value"].as<std::array<float, 3>>();
        for (const float c : v) {
            if (!(std::isfinite(c) && c >= 0)) fail("a colour must be finite and not negative");
        }
        return {v[0], v[1], v[2]};
    }

 private:
    const json* value_;
    std::string file_;
    std::string place_;
};

json parse(const fs::path& file) {
    try {
        return json::parse(read_file(file), nullptr, true, /*ignore_comments=*/true);
    } catch (const json::parse_error& e) {
        // nlohmann's message names line and column after its own error number.
        const std::string what = e.what();
        throw Error(Errc::InvalidArgument,
                    "scene '" + file.string() + "': " + what.substr(what.find("] ") + 2));
    }
}

// Row-vector matrices: the basis vectors are the rows, the translation is entries 12 to 14.
Transform transform_from_matrix(const Node& node) {
    const auto m = node.floats(1);
    if (m.size() != 12 && m.size() != 16) node.fail("expected 12 or 16 numbers");
    Transform transform;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            // A 12-entry matrix has no translation row.
            const std::size_t entry = 4 * column + row;
            transform.rows[row][column] = entry < m.size() ? m[entry] : 0;
        }
    }
    return transform;
}

// In column vectors T Ry Rx Rz S, angles in degrees.
Transform transform_from_parts(const Node& node) {
    const Vec3 position = node.vec3_or("position", {});
    const Vec3 degrees = node.vec3_or("rotation", {});
    const Vec3 scale = node.vec3_or("scale", {1, 1, 1});
    const auto radians = [](float angle) { return angle * kPi / 180; };
    const float cx = std::cos(radians(degrees.x)), sx = std::sin(radians(degrees.x));
    const float cy = std::cos(radians(degrees.y)), sy = std::sin(radians(degrees.y));
    const float cz = std::cos(radians(degrees.z)), sz = std::sin(radians(degrees.z));
    Transform t;
    t.rows[0] = {scale.x * (cy * cz + sy * sx * sz), scale.y * (sy * sx * cz - cy * sz),
                 scale.z * sy * cx, position.x};
    t.rows[1] = {scale.x * cx * sz, scale.y * cx * cz, scale.z * -sx, position.y};
    t.rows[2] = {scale.x * (cy * sx * sz - sy * cz), scale.y * (sy * sz + cy * sx * cz),
                 scale.z * cy * cx, position.z};
    return t;
}

PerspectiveCamera read_camera(const Node& root) {
    std::map<std::string, Transform> transforms;
    for (const Node& node : root.list("transforms")) {
        transforms[node["name"].as<std::string>()] =
            node.has("matrix") ? transform_from_matrix(node["matrix"]) : transform_from_parts(node);
    }
    const std::vector<Node> cameras = root.list("cameras");
    if (cameras.empty()) root.fail("the scene has no camera");
    const Node& camera = cameras.back();
    if (const auto type = camera["type"].as<std::string>(); type != "perspective") {
        camera["type"].fail("cameras of type '" + type + "' are not supported; known: perspective");
    }
    const auto name = camera["transform"].as<std::string>();
    const auto transform = transforms.find(name);
    if (transform == transforms.end()) {
        camera["transform"].fail("unknown transform '" + name + "'");
    }
    const float fov = camera.number_or("fov", 0);
    if (!(fov > 0 && fov < 180)) camera["fov"].fail("is not between 0 and 180 degrees");
    return {.to_world = transform->second, .vertical_fov_degrees = fov};
}

// specularTintStrength, diffuseTransmittance and thin, which exporters write, are not read by the
// renderer that the format belongs to, and so not here either.
Material read_material(const Node& node) {
    const Rgb base_color = node.has("baseColor") ? node["baseColor"].rgb() : kWhite;
    if (node.value_or<std::string>("type", "generic") == "diffuse") {
        return DiffuseMaterial{.reflectance = base_color};
    }
    if (node.number_or("specularTransmittance", 0) != 0) {
        node["specularTransmittance"].fail("transmission is not supported");
    }
    if (node.has("roughness") && node["roughness"].is_string()) {
        node["roughness"].fail("textures are not supported");
    }
    const float ior = node.number_or("IOR", 1.01F);
    if (!(ior >= 1)) node["IOR"].fail("is below 1");
    return GenericMaterial({.base_color = base_color,
                            .roughness = node.fraction_or("roughness", 0.5F),
                            .anisotropic = node.fraction_or("anisotropic", 0),
                            .ior = ior,
                            .metallic = node.fraction_or("metallic", 0),
                            .specular_tint = node.fraction_or("specularTint", 0)});
}

std::vector<Vec3> to_vec3(const std::vector<float>& flat) {
    std::vector<Vec3> result;
    for (std::size_t i = 0; i < flat.size(); i += 3) {
        result.push_back({flat[i], flat[i + 1], flat[i + 2]});
    }
    return result;
}

Mesh read_inline_mesh(const Node& node) {
    Mesh mesh;
    mesh.positions = to_vec3(node["vertices"].floats(3));
    if (node.has("normals")) mesh.normals = to_vec3(node["normals"].floats(3));
    if (node.has("uv")) {
        const auto flat = node["uv"].floats(2);
        for (std::size_t i = 0; i < flat.size(); i += 2) mesh.uvs.push_back({flat[i], flat[i + 1]});
    }
    const auto indices = node["indices"].as<std::vector<std::int64_t>>();
    if (indices.size() % 3 != 0) node["indices"].fail("expected three indices a triangle");
    const auto n = static_cast<std::int64_t>(mesh.positions.size());
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        TriangleIndices triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            if (indices[i + k] < 0 || indices[i + k] >= n) {
                node["indices"].fail("index " + std::to_string(indices[i + k]) + " names none of " +
                                     std::to_string(n) + " vertices");
            }
            triangle[k] = static_cast<std::uint32_t>(indices[i + k]);
        }
        mesh.triangles.push_back(triangle);
    }
    for (const std::size_t size : {mesh.normals.size(), mesh.uvs.size()}) {
        if (size != 0 && size != mesh.positions.size()) {
            node.fail("normals and uv must be one a vertex");
        }
    }
    return mesh;
}

class Importer {
 public:
    explicit Importer(const fs::path& file)
        : file_(file), json_(parse(file)), root_(&json_, file.string(), "") {}

    SceneDescription read() {
        scene_.camera = read_camera(root_);
        for (const Node& node : root_.list("materials")) {
            materials_.insert_or_assign(node["name"].as<std::string>(), node);
        }
        if (root_.has("background")) root_["background"].fail("backgrounds are not supported");
        for (const Node& object : root_.list("objects")) read_object(object);
        return std::move(scene_);
    }

 private:
    void read_object(const Node& object) {
        const auto type = object["type"].as<std::string>();
        if (type == "obj") {
            for (ObjPart& part : read_obj(file_of(object))) {
                add(object, part.material, std::move(part.mesh));
            }
        } else if (type == "ply") {
            add(object, object["material"].as<std::string>(), read_ply(file_of(object)));
        } else if (type == "trimesh") {
            add(object, object["material"].as<std::string>(), read_inline_mesh(object));
        } else {
            object["type"].fail("objects of type '" + type +
                                "' are not supported; known: obj ply trimesh");
        }
    }

    fs::path file_of(const Node& object) const {
        return file_.parent_path() / object["relativePath"].as<std::string>();
    }

    // Gives the mesh its material and emission, checks its numbers, normalises its normals.
    void add(const Node& object, const std::string& material, Mesh mesh) {
        const auto found = materials_.find(material);
        if (found == materials_.end()) {
            std::string known;
            for (const auto& [name, node] : materials_) known += " '" + name + "'";
            object.fail("unknown material '" + material + "'; known:" + known);
        }
        mesh.name = object.value_or<std::string>("name", "");
        mesh.material = material_index(found->first, found->second);
        for (const Node& emitter : {found->second, object}) {
            if (emitter.has("emission")) mesh.emission = emitter["emission"].rgb();
        }
        for (const Vec3 p : mesh.positions) {
            if (!std::isfinite(p.x + p.y + p.z)) object.fail("a vertex is not finite");
        }
        for (Vec3& n : mesh.normals) {
            const float size = length(n);
            n = std::isfinite(size) && size > 0 ? (1 / size) * n : Vec3{};
        }
        scene_.meshes.push_back(std::move(mesh));
    }

    // Materials are read when a mesh uses them: an unused one that we cannot model is no error.
    std::size_t material_index(const std::string& name, const Node& node) {
        const auto [known, is_new] = indices_.try_emplace(name, scene_.materials.size());
        if (is_new) {
            if (node.value_or<bool>("emissionIsGlossy", false)) {
                node["emissionIsGlossy"].fail("glossy emission is not supported");
            }
            scene_.materials.push_back(read_material(node));
        }
        return known->second;
    }

    fs::path file_;
    json json_;
    Node root_;
    std::map<std::string, Node> materials_;
    std::map<std::string, std::size_t> indices_;
    SceneDescription scene_;
};

}  // namespace

SceneDescription import_seesharp(const fs::path& file) { return Importer(file).read(); }

std::vector<std::string> seesharp_references(const fs::path& file) {
    const json scene = parse(file);
    std::vector<std::string> names;
    const Node root(&scene, file.string(), "");
    for (const Node& object : root.list("objects")) {
        if (object.has("relativePath")) names.push_back(object["relativePath"].as<std::string>());
    }
    return names;
}

}  // namespace misbench
