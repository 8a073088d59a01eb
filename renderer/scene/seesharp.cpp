#include "renderer/scene/seesharp.h"

#include <map>
#include <nlohmann/json.hpp>

#include "renderer/base/error.h"
#include "renderer/scene/json_node.h"
#include "renderer/scene/obj.h"
#include "renderer/scene/ply.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;

// {"type": "rgb", "value": [r, g, b]}, finite and not negative; the type may be left out.
Rgb read_rgb(const JsonNode& node) {
    if (const auto type = node.string_or("type", "rgb"); type != "rgb") {
        node.fail("colours of type '" + type + "' are not supported here; known: rgb");
    }
    const Vec3 v = node["value"].vec3();
    if (v.x < 0 || v.y < 0 || v.z < 0) node.fail("a colour must not be negative");
    return {v.x, v.y, v.z};
}

// The file of a colour that is an image: "image" and "filename" in current files, "texture" and
// "path" in old ones.
std::optional<std::string> image_of(const JsonNode& color) {
    const auto type = color.string_or("type", "rgb");
    if (type == "image") return color["filename"].string();
    if (type == "texture") return color["path"].string();
    return std::nullopt;
}

std::string background_file(const JsonNode& background) {
    if (const auto type = background["type"].string(); type != "image") {
        background["type"].fail("backgrounds of type '" + type +
                                "' are not supported; known: image");
    }
    return background["filename"].string();
}

// Row-vector matrices: the basis vectors are the rows, the translation is entries 12 to 14.
Transform transform_from_matrix(const JsonNode& node) {
    const auto m = node.numbers(1);
    // Without a translation row, and with one.
    if (m.size() != 12 && m.size() != 16) node.fail("expected 12 or 16 numbers");
    Transform transform;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            const std::size_t entry = 4 * column + row;
            transform.rows[row][column] = entry < m.size() ? m[entry] : 0;
        }
    }
    const bool is_affine = m[3] == 0 && m[7] == 0 && m[11] == 0 && (m.size() == 12 || m[15] == 1);
    if (!is_affine) node.fail("is not affine: the fourth column is not 0 0 0 1");
    return transform;
}

// In column vectors T Ry Rx Rz S, angles in degrees.
Transform transform_from_parts(const JsonNode& node) {
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

Transform read_transform(const JsonNode& node) {
    const Transform transform =
        node.has("matrix") ? transform_from_matrix(node["matrix"]) : transform_from_parts(node);
    const auto column = [&transform](std::size_t i) {
        return Vec3{transform.rows[0][i], transform.rows[1][i], transform.rows[2][i]};
    };
    const float volume = dot(cross(column(0), column(1)), column(2));
    if (!(std::isfinite(volume) && volume != 0)) node.fail("the transform cannot be inverted");
    return transform;
}

PerspectiveCamera read_camera(const JsonNode& root) {
    const std::vector<JsonNode> cameras = root.list("cameras");
    if (cameras.empty()) root.fail("the scene has no camera");
    const JsonNode& camera = cameras.back();
    if (const auto type = camera["type"].string(); type != "perspective") {
        camera["type"].fail("cameras of type '" + type + "' are not supported; known: perspective");
    }
    const auto name = camera["transform"].string();
    std::optional<Transform> to_world;
    for (const JsonNode& node : root.list("transforms")) {
        if (node["name"].string() == name) to_world = read_transform(node);
    }
    if (!to_world) camera["transform"].fail("unknown transform '" + name + "'");
    const float fov = camera["fov"].number();
    if (!(fov > 0 && fov < 180)) camera["fov"].fail("is not between 0 and 180 degrees");
    return {.to_world = *to_world, .fov_degrees = fov};
}

std::vector<Vec3> to_vec3(const std::vector<float>& flat) {
    std::vector<Vec3> result;
    result.reserve(flat.size() / 3);
    for (std::size_t i = 0; i < flat.size(); i += 3) {
        result.push_back({flat[i], flat[i + 1], flat[i + 2]});
    }
    return result;
}

Mesh read_inline_mesh(const JsonNode& node) {
    Mesh mesh;
    mesh.positions = to_vec3(node["vertices"].numbers(3));
    if (node.has("normals")) mesh.normals = to_vec3(node["normals"].numbers(3));
    if (node.has("uv")) {
        const auto flat = node["uv"].numbers(2);
        for (std::size_t i = 0; i < flat.size(); i += 2) mesh.uvs.push_back({flat[i], flat[i + 1]});
    }
    for (const std::size_t size : {mesh.normals.size(), mesh.uvs.size()}) {
        if (size != 0 && size != mesh.positions.size()) {
            node.fail("normals and uv must be one a vertex");
        }
    }
    const auto indices = node["indices"].indices(mesh.positions.size());
    if (indices.size() % 3 != 0) node["indices"].fail("expected three indices a triangle");
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    }
    return mesh;
}

// Refuses numbers that nothing can be computed with, and gives normals unit length. A normal
// without length stays 0: the face's own stands in for it.
void check_and_normalize(const JsonNode& object, Mesh& mesh) {
    const auto is_finite = [](Vec3 v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), is_finite)) {
        object.fail("a vertex is not finite");
    }
    if (!std::all_of(mesh.normals.begin(), mesh.normals.end(), is_finite)) {
        object.fail("a normal is not finite");
    }
    for (Vec3& n : mesh.normals) {
        const float size = length(n);
        n = size > 0 && std::isfinite(size) ? (1 / size) * n : Vec3{};
    }
}

class Importer {
 public:
    explicit Importer(const fs::path& file)
        : file_(file), json_(parse_json_file(file)), root_(json_, file) {}

    SceneDescription read() {
        scene_.camera = read_camera(root_);
        if (root_.has("background")) read_background(root_["background"]);
        for (const JsonNode& node : root_.list("materials")) {
            const auto name = node["name"].string();
            if (!materials_.try_emplace(name, node).second) {
                node.fail("the name '" + name + "' is taken");
            }
        }
        for (const JsonNode& object : root_.list("objects")) read_object(object);
        for (const auto& [key, materials] : ignored_) {
            scene_.notes.push_back("'" + key + "' is ignored, as SeeSharp does:" + materials);
        }
        return std::move(scene_);
    }

 private:
    // Longitude in the file is as in EnvironmentDescription's own frame.
    void read_background(const JsonNode& node) {
        Image radiance = read_radiance_map(file_.parent_path() / background_file(node));
        scene_.environment = {.radiance = std::make_shared<const Image>(std::move(radiance)),
                              .filter = EnvironmentDescription::Filter::Nearest};
    }

    // One texture and one image a file.
    std::int32_t texture(const std::string& name) {
        const auto [known, is_new] =
            textures_.try_emplace(name, static_cast<std::int32_t>(scene_.textures.size()));
        if (is_new) {
            scene_.textures.emplace_back(
                BitmapTexture{.image = std::make_shared<const TextureImage>(TextureImage::read(
                                  file_.parent_path() / name, TextureImage::Encoding::Srgb))});
        }
        return known->second;
    }

    Layer read_layer(const std::string& name, const JsonNode& node) {
        const JsonNode color = node["baseColor"];
        const std::optional<std::string> image = image_of(color);
        const Rgb base_color = image ? kWhite : read_rgb(color);
        if (max_channel(base_color) > 1) color.fail("reflects more light than it receives");
        const std::int32_t color_texture = image ? texture(*image) : kNoTexture;
        if (node.string_or("type", "generic") == "diffuse") {
            if (node.boolean_or("thin", false)) {
                node["thin"].fail("diffuse transmission is not supported");
            }
            return {.material = DiffuseMaterial{.reflectance = base_color},
                    .color_texture = color_texture};
        }
        if (const auto type = node.string_or("type", "generic"); type != "generic") {
            scene_.notes.push_back("material '" + name + "' of type '" + type +
                                   "' is read as generic, as SeeSharp does");
        }
        if (node.boolean_or("thin", false)) ignore("thin", name);
        if (node.number_or("diffuseTransmittance", 0) != 0) ignore("diffuseTransmittance", name);
        if (node.number_or("specularTintStrength", 0) != 0) ignore("specularTintStrength", name);
        const bool is_textured = node.has("roughness") && node["roughness"].is_string();
        const float ior = node.number_or("IOR", 1.01F);
        if (!(ior >= 1)) node["IOR"].fail("is below 1");
        return {
            .material = GenericMaterial(
                {.base_color = base_color,
                 .roughness = is_textured ? 0.5F : node.fraction_or("roughness", 0.5F),
                 .anisotropic = node.fraction_or("anisotropic", 0),
                 .ior = ior,
                 .metallic = node.fraction_or("metallic", 0),
                 .specular_tint = node.fraction_or("specularTint", 0),
                 .specular_transmittance = node.fraction_or("specularTransmittance", 0)}),
            .color_texture = color_texture,
            .roughness_texture = is_textured ? texture(node["roughness"].string()) : kNoTexture};
    }

    void ignore(const std::string& key, const std::string& material) {
        ignored_[key] += " '" + material + "'";
    }

    void read_object(const JsonNode& object) {
        const auto type = object["type"].string();
        if (type == "obj") {
            for (ObjPart& part : read_obj(file_of(object))) {
                add(object, part.material, std::move(part.mesh));
            }
        } else if (type == "ply") {
            add(object, object["material"].string(), read_ply(file_of(object)));
        } else if (type == "trimesh") {
            add(object, object["material"].string(), read_inline_mesh(object));
        } else {
            object["type"].fail("objects of type '" + type +
                                "' are not supported; known: obj ply trimesh");
        }
    }

    fs::path file_of(const JsonNode& object) const {
        return file_.parent_path() / object["relativePath"].string();
    }

    // Gives the mesh its material and emission and makes its numbers fit for use.
    void add(const JsonNode& object, const std::string& material, Mesh mesh) {
        const auto found = materials_.find(material);
        if (found == materials_.end()) {
            std::string known;
            for (const auto& [name, node] : materials_) known += " '" + name + "'";
            object.fail("unknown material '" + material + "'; known:" + known);
        }
        mesh.name = object.string_or("name", "");
        mesh.material = material_index(found->first, found->second);
        for (const JsonNode& emitter : {found->second, object}) {
            if (emitter.has("emission")) mesh.emission = read_emission(emitter);
        }
        check_and_normalize(object, mesh);
        fit_uvs(object, mesh);
        scene_.meshes.push_back(std::move(mesh));
    }

    // Radiance of a material or an object.
    static Rgb read_emission(const JsonNode& emitter) {
        const Rgb radiance = read_rgb(emitter["emission"]);
        if (!(radiance == Rgb{}) && emitter.boolean_or("emissionIsGlossy", false)) {
            emitter["emissionIsGlossy"].fail("glossy emission is not supported");
        }
        if (const auto unit = emitter["emission"].string_or("unit", "radiance");
            unit != "radiance") {
            emitter["emission"]["unit"].fail("unknown unit '" + unit + "'; known: radiance");
        }
        return radiance;
    }

    // Textures need finite coordinates; without a texture nothing reads them.
    void fit_uvs(const JsonNode& object, Mesh& mesh) {
        const SurfaceMaterial& material = scene_.materials[mesh.material];
        const Layer& layer = material.front.layer;
        if (layer.color_texture == kNoTexture && layer.roughness_texture == kNoTexture) {
            mesh.uvs.clear();
            return;
        }
        if (mesh.uvs.empty()) {
            mesh.uvs.resize(mesh.positions.size());
            scene_.notes.push_back("object '" + mesh.name +
                                   "' has no texture coordinates: all of '" + material.name +
                                   "' is looked up at 0 0, as SeeSharp does");
        }
        for (const Vec2 uv : mesh.uvs) {
            if (!(std::isfinite(uv.x) && std::isfinite(uv.y))) {
                object.fail("a texture coordinate under material '" + material.name +
                            "' is not finite");
            }
        }
    }

    // Materials are read when a mesh uses them: an unused one that we cannot model is no error.
    std::size_t material_index(const std::string& name, const JsonNode& node) {
        const auto [known, is_new] = indices_.try_emplace(name, scene_.materials.size());
        if (is_new) {
            scene_.materials.push_back({.name = name, .front = {.layer = read_layer(name, node)}});
        }
        return known->second;
    }

    fs::path file_;
    nlohmann::json json_;
    JsonNode root_;
    std::map<std::string, JsonNode> materials_;
    std::map<std::string, std::size_t> indices_;    // into scene_.materials
    std::map<std::string, std::int32_t> textures_;  // by file, into scene_.textures
    std::map<std::string, std::string> ignored_;    // keys, and the materials that have them
    SceneDescription scene_;
};

}  // namespace

SceneDescription import_seesharp(const fs::path& file) { return Importer(file).read(); }

std::vector<std::string> seesharp_references(const fs::path& file) {
    const nlohmann::json json = parse_json_file(file);
    const JsonNode root(json, file);
    std::vector<std::string> names;
    if (root.has("background")) names.push_back(background_file(root["background"]));
    for (const JsonNode& material : root.list("materials")) {
        if (material.has("baseColor")) {
            if (const auto image = image_of(material["baseColor"])) names.push_back(*image);
        }
        if (material.has("roughness") && material["roughness"].is_string()) {
            names.push_back(material["roughness"].string());
        }
    }
    for (const JsonNode& object : root.list("objects")) {
        if (object.has("relativePath")) names.push_back(object["relativePath"].string());
    }
    return names;
}

}  // namespace misbench
