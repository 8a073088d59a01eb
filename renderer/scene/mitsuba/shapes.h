// Shapes, their emission, and copies of shape groups.
#pragma once

#include <map>

#include "renderer/scene/mitsuba/bsdfs.h"
#include "renderer/scene/mitsuba/context.h"
#include "renderer/scene/mitsuba/object.h"

namespace misbench::mitsuba {

// Copies of shape groups included: what a machine of 32 GB renders.
inline constexpr std::size_t kMaxTriangles = 50'000'000;

class Shapes {
 public:
    explicit Shapes(Context& context) : context_(context), bsdfs_(context) {}

    // Adds the shapes of the top level to the scene.
    void read(const std::vector<Object*>& shapes);

 private:
    struct Group {
        std::vector<Mesh> meshes;
        std::vector<Quadric> quadrics;
        std::size_t n_triangles = 0;
    };
    struct Look {
        std::size_t material = 0;
        Rgb emission{};
    };

    void read_shape(Object& object, Group& into);
    void read_mesh(Object& object, Group& into);
    void read_quadric(Object& object, Group& into);
    std::vector<Mesh> load(Object& object);
    std::vector<Mesh> load_obj(Object& object);
    Look read_look(Object& object);
    Transform read_to_world(Object& object);

    const Group& group_of(Object& instance);
    std::size_t count_copied_triangles(const std::vector<Object*>& shapes);
    void add_copy(Object& instance);

    Context& context_;
    Bsdfs bsdfs_;
    std::map<const Object*, Group> groups_;
};

}  // namespace misbench::mitsuba
