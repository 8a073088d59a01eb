#include "renderer/scene/mitsuba/object.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "renderer/base/error.h"

namespace misbench::mitsuba {
namespace {

constexpr std::string_view kSeparators = ", \t\r\n";

std::string joined(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += ' ' + name;
    return text.empty() ? " none" : text;
}

}  // namespace

void Place::fail(const std::string& reason) const {
    throw Error(Errc::InvalidArgument, "scene '" + file + "': line " + std::to_string(line) + ":" +
                                           std::to_string(column) + ": " + reason);
}

void Property::fail(const std::string& reason) const {
    place.fail((name.empty() ? type : "'" + name + "'") + ": " + reason);
}

const std::string& Property::attribute(const char* attribute_name) const {
    const auto found = attributes.find(attribute_name);
    if (found == attributes.end()) fail(std::string("missing '") + attribute_name + "'");
    return found->second;
}

std::vector<double> Property::numbers(const char* attribute_name) const {
    const std::string& text = attribute(attribute_name);
    std::vector<double> values;
    for (std::size_t at = text.find_first_not_of(kSeparators); at != std::string::npos;) {
        const std::size_t end = std::min(text.find_first_of(kSeparators, at), text.size());
        std::string_view token = std::string_view(text).substr(at, end - at);
        if (token.starts_with('+')) token.remove_prefix(1);
        double value = 0;
        const auto [stop, status] =
            std::from_chars(token.data(), token.data() + token.size(), value);
        if (status != std::errc() || stop != token.data() + token.size() || !std::isfinite(value)) {
            fail("'" + text.substr(at, end - at) + "' is not a finite number");
        }
        values.push_back(value);
        at = text.find_first_not_of(kSeparators, end);
    }
    return values;
}

double Property::number(const char* attribute_name) const {
    const std::vector<double> values = numbers(attribute_name);
    if (values.size() != 1) {
        fail("expected one number, found " + std::to_string(values.size()));
    }
    return values[0];
}

Vec3 Property::vec3(float where_absent) const {
    if (has("value")) {
        if (has("x") || has("y") || has("z")) fail("has both 'value' and coordinates");
        const std::vector<double> v = numbers();
        if (v.size() != 1 && v.size() != 3) {
            fail("expected one or three numbers, found " + std::to_string(v.size()));
        }
        const auto number_at = [&v](std::size_t i) { return static_cast<float>(v[i % v.size()]); };
        return {number_at(0), number_at(1), number_at(2)};
    }
    const auto coordinate = [&](const char* axis) {
        return has(axis) ? static_cast<float>(number(axis)) : where_absent;
    };
    return {coordinate("x"), coordinate("y"), coordinate("z")};
}

void Object::fail(const std::string& reason) const { place.fail(title() + ": " + reason); }

void Object::refuse_type(std::string_view known) const {
    place.fail(title() + " is not supported; known: " + std::string(known));
}

const Property* Object::find(const std::string& name) {
    asked_.insert(name);
    for (const Child& c : children) {
        if (c.name == name)
            c.place.fail("'" + name + "' of " + title() + " cannot be a " + c.object->tag);
    }
    for (Property& property : properties) {
        if (property.name != name) continue;
        property.is_read = true;
        return &property;
    }
    return nullptr;
}

bool Object::has(const std::string& name) {
    asked_.insert(name);
    const auto is_named = [&name](const auto& part) { return part.name == name; };
    return std::any_of(properties.begin(), properties.end(), is_named) ||
           std::any_of(children.begin(), children.end(), is_named);
}

const Property& Object::typed(const Property& property,
                              std::initializer_list<std::string_view> types) {
    if (std::find(types.begin(), types.end(), property.type) == types.end()) {
        property.fail("expected a " + std::string(*types.begin()) + ", found a " + property.type);
    }
    return property;
}

std::string Object::text(const std::string& name) {
    const Property* property = find(name);
    if (property == nullptr) fail("missing '" + name + "'");
    return typed(*property, {"string"}).attribute("value");
}

std::string Object::text(const std::string& name, const std::string& fallback) {
    return find(name) == nullptr ? fallback : text(name);
}

float Object::number(const std::string& name, float fallback) {
    const Property* property = find(name);
    if (property == nullptr) return fallback;
    return static_cast<float>(typed(*property, {"float", "integer"}).number());
}

float Object::positive(const std::string& name, float fallback) {
    const float value = number(name, fallback);
    if (!(value > 0)) find(name)->fail("must be above 0");
    return value;
}

std::int64_t Object::integer(const std::string& name, std::int64_t fallback) {
    const Property* property = find(name);
    if (property == nullptr) return fallback;
    const double value = typed(*property, {"integer"}).number();
    // Nothing that a scene counts is larger, and a double holds these exactly.
    if (value != std::floor(value) || std::abs(value) > 2147483647.0) {
        property->fail("expected a whole number");
    }
    return static_cast<std::int64_t>(value);
}

bool Object::boolean(const std::string& name, bool fallback) {
    const Property* property = find(name);
    if (property == nullptr) return fallback;
    const std::string& value = typed(*property, {"boolean"}).attribute("value");
    if (value != "true" && value != "false") property->fail("expected true or false");
    return value == "true";
}

Vec3 Object::vec3(const std::string& name, Vec3 fallback) {
    const Property* property = find(name);
    return property == nullptr ? fallback : typed(*property, {"point", "vector"}).vec3(0);
}

Transform Object::transform(const std::string& name) {
    const Property* property = find(name);
    return property == nullptr ? Transform{} : read_transform(typed(*property, {"transform"}));
}

Object* Object::child(const std::string& name) {
    asked_.insert(name);
    for (Child& c : children) {
        if (c.name != name) continue;
        c.is_read = true;
        return c.object;
    }
    return nullptr;
}

std::vector<Object*> Object::children_of(std::string_view wanted) {
    std::vector<Object*> found;
    for (Child& c : children) {
        if (c.object->tag != wanted) continue;
        c.is_read = true;
        found.push_back(c.object);
    }
    return found;
}

void Object::ignore(std::initializer_list<const char*> names) {
    for (const char* name : names) find(name);
}

void Object::expect_all_read() const {
    for (const Property& property : properties) {
        if (property.is_read) continue;
        property.place.fail("unknown parameter '" + property.name + "' of " + title() +
                            "; known:" + joined(asked_));
    }
    for (const Child& c : children) {
        if (c.is_read) continue;
        c.place.fail(title() + " cannot hold " + c.object->title() +
                     (c.name.empty() ? "" : " as '" + c.name + "'") +
                     "; known parameters:" + joined(asked_));
    }
}

}  // namespace misbench::mitsuba
