#include "renderer/scene/mitsuba/shapes.h"

#include <cmath>

#include "renderer/scene/mitsuba/meshes.h"
#include "renderer/scene/mitsuba/spectrum.h"
#include "renderer/scene/mitsuba/transform.h"
#include "renderer/scene/obj.h"
#include "renderer/scene/ply.h"
#include "renderer/scene/serialized.h"

namespace misbench::mitsuba {
namespace {

constexpr std::string_view kKnown =
    "obj ply serialized rectangle cube sphere disk cylinder shapegroup instance";

bool is_quadric(const Object& object) {
    return object.type == "sphere" || object.type == "disk" || object.type == "cylinder";
}

std::string name_of(Object& object) { return object.id.empty() ? object.type : object.id; }

// v from the top of an image to its bottom.
void flip_v(Mesh& mesh) {
    for (Vec2& uv : mesh.uvs) uv.y = 1 - uv.y;
}

Transform sphere_to_unit_frame(Object& object) {
    const Vec3 center = object.vec3("center", {});
    const float radius = object.positive("radius", 1);
    return compose(translation(center), scaling({radius, radius, radius}));
}

Transform cylinder_to_unit_frame(Object& object) {
    const Vec3 p0 = object.vec3("p0", {});
    const Vec3 axis = object.vec3("p1", {0, 0, 1}) - p0;
    const float radius = object.positive("radius", 1);
    if (!(length(axis) > 0)) object.fail("'p0' and 'p1' are the same point");
    const Frame frame = Frame::from_z(normalized(axis));
    return from_columns(radius * frame.x, radius * frame.y, axis, p0);
}

// An exact intersection needs a round shape; Mitsuba warns where it is not.
void expect_round(const Object& object, const Quadric& quadric) {
    const Transform& t = quadric.to_world;
    const bool is_round = at_right_angles(t, 0, 1) && at_right_angles(t, 1, 2) &&
                          at_right_angles(t, 2, 0) && same_length(t, 0, 1) &&
                          (quadric.shape != Quadric::Shape::Sphere || same_length(t, 1, 2));
    if (!is_round)
        object.fail("'to_world' shears it, or scales it differently in directions across");
}

}  // namespace

void Shapes::read(const std::vector<Object*>& shapes) {
    Group scene;
    scene.n_triangles = count_copied_triangles(shapes);
    for (Object* shape : shapes) {
        if (shape->type == "instance") {
            add_copy(*shape);
        } else if (shape->type != "shapegroup") {
            read_shape(*shape, scene);
        }
    }
    const auto append = [](auto& to, auto& from) {
        to.insert(to.end(), std::make_move_iterator(from.begin()),
                  std::make_move_iterator(from.end()));
    };
    append(context_.scene.meshes, scene.meshes);
    append(context_.scene.quadrics, scene.quadrics);
}

void Shapes::read_shape(Object& object, Group& into) {
    if (is_quadric(object)) {
        read_quadric(object, into);
    } else {
        read_mesh(object, into);
    }
    if (into.n_triangles > kMaxTriangles) {
        object.fail("the scene has more than " + std::to_string(kMaxTriangles) + " triangles");
    }
}

Transform Shapes::read_to_world(Object& object) {
    const Transform to_world = object.transform("to_world");
    const double det = determinant(to_world);
    if (!(std::isfinite(det) && det != 0)) object.fail("'to_world' cannot be inverted");
    return to_world;
}

Shapes::Look Shapes::read_look(Object& object) {
    const std::vector<Object*> bsdfs = object.children_of("bsdf");
    const std::vector<Object*> emitters = object.children_of("emitter");
    if (bsdfs.size() > 1) object.fail("more than one bsdf is not supported");
    if (emitters.size() > 1) object.fail("more than one emitter is not supported");
    Look look;
    if (!emitters.empty()) {
        Object& emitter = *emitters[0];
        if (emitter.type != "area") emitter.refuse_type("area");
        emitter.ignore({"sampling_weight"});
        look.emission = read_color(context_, emitter, "radiance", ColorRole::Emission, kWhite);
        emitter.expect_all_read();
    }
    look.material =
        bsdfs.empty() ? bsdfs_.default_index(!emitters.empty()) : bsdfs_.index_of(*bsdfs[0]);
    const TexturedNumber& opacity = context_.scene.materials[look.material].opacity;
    if (!emitters.empty() && (opacity.texture != kNoTexture || opacity.value != 1)) {
        emitters[0]->fail("on a surface with a mask is not supported");
    }
    return look;
}

void Shapes::read_mesh(Object& object, Group& into) {
    std::vector<Mesh> meshes = load(object);
    const Placement placement{.to_world = read_to_world(object),
                              .face_normals = object.boolean("face_normals", false),
                              .flip_normals = object.boolean("flip_normals", false)};
    const Look look = read_look(object);
    object.expect_all_read();
    const bool is_flat = object.type == "rectangle" || object.type == "cube";
    for (Mesh& mesh : meshes) {
        place_mesh(mesh, placement);
        // The normals of these are those of their faces.
        if (is_flat) mesh.normals.clear();
        for (const Vec3 p : mesh.positions) {
            if (!std::isfinite(p.x + p.y + p.z)) object.fail("a vertex is not finite");
        }
        mesh.name = name_of(object);
        mesh.material = look.material;
        mesh.emission = look.emission;
        into.n_triangles += mesh.triangles.size();
        into.meshes.push_back(std::move(mesh));
    }
}

std::vector<Mesh> Shapes::load(Object& object) {
    std::vector<Mesh> meshes;
    if (object.type == "rectangle") {
        meshes.push_back(rectangle());
    } else if (object.type == "cube") {
        meshes.push_back(cube());
    } else if (object.type == "obj") {
        meshes = load_obj(object);
    } else if (object.type == "ply") {
        object.ignore({"srgb"});  // of vertex colours, which we do not read
        meshes.push_back(read_ply(context_.folder / object.text("filename")));
        if (object.boolean("flip_tex_coords", false)) flip_v(meshes[0]);
    } else if (object.type == "serialized") {
        const std::int64_t index = object.integer("shape_index", 0);
        if (index < 0) object.fail("'shape_index' must not be negative");
        meshes.push_back(read_serialized(context_.folder / object.text("filename"),
                                         static_cast<std::size_t>(index)));
    } else {
        object.refuse_type(kKnown);
    }
    return meshes;
}

std::vector<Mesh> Shapes::load_obj(Object& object) {
    object.ignore({"collapse"});  // of an OBJ's groups into one shape: the same triangles
    const std::string file = object.text("filename");
    const bool flips = object.boolean("flip_tex_coords", true);
    std::vector<Mesh> meshes;
    for (ObjPart& part : read_obj(context_.folder / file)) {
        // The reader turns v already.
        if (!flips) flip_v(part.mesh);
        meshes.push_back(std::move(part.mesh));
    }
    if (meshes.size() > 1 && meshes[0].normals.empty()) {
        context_.note("smooth normals of '" + file + "' end where its materials change");
    }
    return meshes;
}

void Shapes::read_quadric(Object& object, Group& into) {
    Quadric quadric;
    Transform local;
    if (object.type == "sphere") {
        quadric.shape = Quadric::Shape::Sphere;
        local = sphere_to_unit_frame(object);
    } else if (object.type == "cylinder") {
        quadric.shape = Quadric::Shape::Cylinder;
        local = cylinder_to_unit_frame(object);
    } else {
        quadric.shape = Quadric::Shape::Disk;
    }
    const Transform to_world = read_to_world(object);
    quadric.to_world = compose(to_world, local);
    quadric.flipped = object.boolean("flip_normals", false);
    // A mirrored sphere of version 3 looks inwards; disks and cylinders do not change.
    if (object.type == "sphere" && !context_.is_old && determinant(to_world) < 0) {
        quadric.flipped = !quadric.flipped;
    }
    const Look look = read_look(object);
    object.expect_all_read();
    quadric.name = name_of(object);
    quadric.material = look.material;
    quadric.emission = look.emission;
    expect_round(object, quadric);
    into.quadrics.push_back(std::move(quadric));
}

const Shapes::Group& Shapes::group_of(Object& instance) {
    const std::vector<Object*> children = instance.children_of("shape");
    if (children.size() != 1 || children[0]->type != "shapegroup") {
        instance.fail("expected one reference to a shapegroup");
    }
    Object& object = *children[0];
    const auto [known, is_new] = groups_.try_emplace(&object);
    if (is_new) {
        for (Object* shape : object.children_of("shape")) {
            if (shape->type == "instance" || shape->type == "shapegroup") {
                shape->fail("a shapegroup in a shapegroup is not supported");
            }
            if (!shape->children_of("emitter").empty()) {
                shape->fail("an emitter in a shapegroup is not supported");
            }
            read_shape(*shape, known->second);
        }
        object.expect_all_read();
    }
    return known->second;
}

// Before any copy is made.
std::size_t Shapes::count_copied_triangles(const std::vector<Object*>& shapes) {
    std::size_t n_triangles = 0;
    for (Object* shape : shapes) {
        if (shape->type != "instance") continue;
        n_triangles += group_of(*shape).n_triangles;
        if (n_triangles > kMaxTriangles) {
            shape->fail("copies of shape groups have more than " + std::to_string(kMaxTriangles) +
                        " triangles");
        }
    }
    return n_triangles;
}

void Shapes::add_copy(Object& instance) {
    const Group& group = group_of(instance);
    const Transform to_world = read_to_world(instance);
    instance.expect_all_read();
    for (Mesh mesh : group.meshes) {
        map_mesh(mesh, to_world);
        context_.scene.meshes.push_back(std::move(mesh));
    }
    for (Quadric quadric : group.quadrics) {
        quadric.to_world = compose(to_world, quadric.to_world);
        expect_round(instance, quadric);
        context_.scene.quadrics.push_back(std::move(quadric));
    }
    ++context_.scene.n_instances;
}

}  // namespace misbench::mitsuba
