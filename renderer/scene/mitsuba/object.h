// A Mitsuba scene file as data: objects (plugins) with typed properties and objects inside them.
// An object remembers what was asked of it, so that a parameter that nobody asked for is an error.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/math/vec.h"

namespace misbench::mitsuba {

// Where something is written.
struct Place {
    std::string file;
    int line = 0;
    int column = 0;

    // Throws InvalidArgument "scene 'FILE': line 12:5: reason".
    [[noreturn]] void fail(const std::string& reason) const;
};

struct Property {
    std::string type;  // the element: float, rgb, transform …
    std::string name;  // in version 3's spelling: to_world for toWorld
    Place place;
    std::map<std::string, std::string> attributes;
    std::vector<Property> operations;  // of a transform, the first one first
    bool is_read = false;

    [[noreturn]] void fail(const std::string& reason) const;
    bool has(const char* attribute) const { return attributes.contains(attribute); }
    const std::string& attribute(const char* name) const;
    // The numbers of an attribute, between commas or spaces; all finite.
    std::vector<double> numbers(const char* attribute = "value") const;
    // Exactly one.
    double number(const char* attribute = "value") const;
    // x, y and z, or three numbers in `value`, or one for all three.
    Vec3 vec3(float where_absent) const;
};

class Object {
 public:
    std::string tag;   // the element: bsdf, shape …
    std::string type;  // the plugin: diffuse, obj …
    std::string id;
    Place place;

    struct Child {
        std::string name;  // the parameter that it stands for, or ""
        std::string ref;   // the id that it was named by, or ""
        Place place;
        Object* object = nullptr;
        bool is_read = false;
    };
    std::vector<Property> properties;
    std::vector<Child> children;

    // "bsdf 'diffuse'".
    std::string title() const { return tag + " '" + type + "'"; }
    // Throws InvalidArgument: file, line, title, reason.
    [[noreturn]] void fail(const std::string& reason) const;
    // Fails with the list of what is known: "bsdf 'phong' is not supported; known: …".
    [[noreturn]] void refuse_type(std::string_view known) const;

    // The property, or none. Fails where an object stands for it.
    const Property* find(const std::string& name);
    bool has(const std::string& name);

    std::string text(const std::string& name);
    std::string text(const std::string& name, const std::string& fallback);
    float number(const std::string& name, float fallback);
    // A number above 0.
    float positive(const std::string& name, float fallback);
    std::int64_t integer(const std::string& name, std::int64_t fallback);
    bool boolean(const std::string& name, bool fallback);
    Vec3 vec3(const std::string& name, Vec3 fallback);
    // The identity where it is absent.
    Transform transform(const std::string& name);

    // The object that stands for a parameter, or none.
    Object* child(const std::string& name);
    // Those of one tag, whatever their names.
    std::vector<Object*> children_of(std::string_view tag);

    // Parameters that change nothing for us.
    void ignore(std::initializer_list<const char*> names);
    // Fails at the first property or child that nobody asked for, naming those that are known.
    void expect_all_read() const;

 private:
    const Property& typed(const Property& property, std::initializer_list<std::string_view> types);

    std::set<std::string> asked_;
};

// The operations of a transform, the first one applied first.
Transform read_transform(const Property& property);

}  // namespace misbench::mitsuba
