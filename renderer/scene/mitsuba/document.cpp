#include "renderer/scene/mitsuba/document.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <pugixml.hpp>
#include <utility>

#include "renderer/base/error.h"
#include "renderer/base/files.h"

namespace misbench::mitsuba {
namespace {

namespace fs = std::filesystem;

// Far more than any scene needs; more is a mistake or an attack.
constexpr int kMaxNesting = 64;
constexpr int kMaxIncludes = 16;  // one inside the other
constexpr std::size_t kMaxAttributeLength = 1 << 16;

// The elements that are values, and their attributes besides `name`.
struct Element {
    std::string_view name;
    std::vector<std::string_view> attributes;
};
const std::array kProperties{
    Element{"string", {"value"}},
    Element{"float", {"value"}},
    Element{"integer", {"value"}},
    Element{"boolean", {"value"}},
    Element{"rgb", {"value"}},
    Element{"srgb", {"value"}},
    Element{"spectrum", {"value"}},
    Element{"blackbody", {"temperature", "scale"}},
    Element{"point", {"value", "x", "y", "z"}},
    Element{"vector", {"value", "x", "y", "z"}},
    Element{"transform", {}},
};
const std::array kOperations{
    Element{"translate", {"value", "x", "y", "z"}},
    Element{"scale", {"value", "x", "y", "z"}},
    Element{"rotate", {"value", "x", "y", "z", "angle"}},
    Element{"matrix", {"value"}},
    Element{"lookat", {"origin", "target", "up"}},
};

template <class Rows>
const Element* element_named(const Rows& rows, std::string_view name) {
    const auto row = std::find_if(rows.begin(), rows.end(),
                                  [name](const Element& element) { return element.name == name; });
    return row == rows.end() ? nullptr : &*row;
}

// toWorld → to_world, intIOR → int_ior, filename → filename.
std::string version_3_spelling(std::string_view name) {
    const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
    std::string spelled;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (is_upper(name[i]) && i > 0 && !is_upper(name[i - 1]) && name[i - 1] != '_') {
            spelled += '_';
        }
        spelled += is_upper(name[i]) ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
    }
    return spelled;
}

// One file: bytes, and where its lines begin.
class Source {
 public:
    explicit Source(const fs::path& file) : name_(file.string()), text_(misbench::read_file(file)) {
        for (std::size_t i = 0; i < text_.size(); ++i) {
            if (text_[i] == '\n') line_starts_.push_back(i + 1);
        }
    }

    const std::string& text() const { return text_; }
    Place place(std::ptrdiff_t offset) const {
        const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0));
        const auto next = std::upper_bound(line_starts_.begin(), line_starts_.end(), at);
        return {name_, static_cast<int>(next - line_starts_.begin()),
                static_cast<int>(at - *std::prev(next)) + 1};
    }

 private:
    std::string name_;
    std::string text_;
    std::vector<std::size_t> line_starts_{0};
};

class Reader {
 public:
    explicit Reader(const fs::path& file) : folder_(file.parent_path()) {
        document_.scene.tag = "scene";
        read_file(file, 0);
        resolve(document_.scene);
        for (Object& object : document_.objects) resolve(object);
        height_of(document_.scene, 0);
    }

    Document take() { return std::move(document_); }

 private:
    // pugixml tells where an element's name begins, after its '<'.
    Place place_of(const pugi::xml_node& node) const {
        return source_->place(node.offset_debug() - 1);
    }

    void read_file(const fs::path& file, int depth) {
        const Source source(file);
        pugi::xml_document xml;
        const pugi::xml_parse_result result =
            xml.load_buffer(source.text().data(), source.text().size());
        if (!result) {
            std::string reason = result.description();
            reason[0] = static_cast<char>(std::tolower(reason[0]));
            source.place(result.offset).fail(reason);
        }
        const Source* outer = std::exchange(source_, &source);
        const pugi::xml_node scene = xml.document_element();
        if (std::string_view(scene.name()) != "scene") {
            place_of(scene).fail(std::string("expected <scene>, found <") + scene.name() + ">");
        }
        read_version(scene, depth);
        if (depth == 0) document_.scene.place = place_of(scene);
        for (const pugi::xml_node& node : scene.children()) read_node(node, document_.scene, depth);
        source_ = outer;
    }

    void read_version(const pugi::xml_node& scene, int depth) {
        const std::string version = scene.attribute("version").value();
        const bool is_old = version.starts_with("0.5.") || version.starts_with("0.6.");
        if (!is_old && !version.starts_with("2.") && !version.starts_with("3.")) {
            place_of(scene).fail("version '" + version + "' is not supported; known: 0.5 0.6 2 3");
        }
        if (depth > 0 && is_old != document_.is_old) {
            place_of(scene).fail("includes mix versions 0.6 and 3");
        }
        document_.is_old = is_old;
    }

    // Replaces $name by the parameter's value, the longest name that fits.
    std::string expanded(const Place& place, std::string text) const {
        std::size_t at = text.find('$');
        while (at != std::string::npos) {
            const std::pair<const std::string, std::string>* best = nullptr;
            for (const auto& parameter : parameters_) {
                const bool fits =
                    text.compare(at + 1, parameter.first.size(), parameter.first) == 0;
                if (fits && (best == nullptr || parameter.first.size() > best->first.size())) {
                    best = &parameter;
                }
            }
            if (best == nullptr) {
                std::string known;
                for (const auto& [name, value] : parameters_) known += " $" + name;
                place.fail("unknown parameter in '" + text + "'; known:" + known);
            }
            text.replace(at, best->first.size() + 1, best->second);
            if (text.size() > kMaxAttributeLength) place.fail("parameters expand without end");
            at = text.find('$', at + best->second.size());
        }
        return text;
    }

    std::string attribute(const pugi::xml_node& node, const char* name) const {
        return expanded(place_of(node), node.attribute(name).value());
    }

    std::string required(const pugi::xml_node& node, const char* name) {
        if (!node.attribute(name)) {
            place_of(node).fail(std::string("<") + node.name() + "> lacks '" + name + "'");
        }
        return attribute(node, name);
    }

    void read_node(const pugi::xml_node& node, Object& parent, int depth) {
        if (node.type() != pugi::node_element) {
            if (node.type() == pugi::node_pcdata) place_of(node).fail("text between elements");
            return;
        }
        if (depth > kMaxNesting) place_of(node).fail("elements are nested too deeply");
        const std::string_view name = node.name();
        const Element* element = element_named(kProperties, name);
        if (name == "default") {
            // What is set first stays, as with parameters of the command line.
            parameters_.try_emplace(required(node, "name"), required(node, "value"));
        } else if (name == "include") {
            if (&parent != &document_.scene) place_of(node).fail("<include> inside an object");
            include(node);
        } else if (name == "alias") {
            const auto found = ids_.find(required(node, "id"));
            if (found == ids_.end()) place_of(node).fail("alias of an unknown id");
            ids_.try_emplace(required(node, "as"), found->second);
        } else if (name == "ref") {
            parent.children.push_back({.name = version_3_spelling(attribute(node, "name")),
                                       .ref = required(node, "id"),
                                       .place = place_of(node)});
        } else if (element != nullptr && !node.attribute("type")) {
            add_property(read_property(node, *element), parent);
        } else if (node.attribute("type")) {
            read_object(node, parent, depth);
        } else {
            place_of(node).fail("unknown element <" + std::string(name) + ">");
        }
    }

    void include(const pugi::xml_node& node) {
        const std::string name = required(node, "filename");
        if (++n_open_includes_ > kMaxIncludes)
            place_of(node).fail("includes are nested too deeply");
        document_.references.push_back(name);
        read_file(folder_ / name, 1);
        --n_open_includes_;
    }

    void add_property(Property property, Object& parent) {
        for (const Property& other : parent.properties) {
            if (other.name == property.name) property.fail("is given twice");
        }
        const bool reads_files =
            parent.tag == "shape" || parent.tag == "texture" || parent.tag == "emitter";
        if (reads_files && property.type == "string" && property.name == "filename") {
            document_.references.push_back(property.attribute("value"));
        }
        parent.properties.push_back(std::move(property));
    }

    Property read_property(const pugi::xml_node& node, const Element& element) {
        Property property = read_attributes(node, element);
        property.name = version_3_spelling(required(node, "name"));
        for (const pugi::xml_node& child : node.children()) {
            if (child.type() != pugi::node_element) continue;
            // Old files write lookAt, newer ones lookat.
            const std::string_view name =
                std::string_view(child.name()) == "lookAt" ? "lookat" : child.name();
            const Element* operation = element_named(kOperations, name);
            if (property.type != "transform" || operation == nullptr) {
                place_of(child).fail("unknown element <" + std::string(child.name()) + "> in <" +
                                     property.type + ">");
            }
            property.operations.push_back(read_attributes(child, *operation));
        }
        return property;
    }

    Property read_attributes(const pugi::xml_node& node, const Element& element) {
        Property property;
        property.type = element.name;
        property.place = place_of(node);
        for (const pugi::xml_attribute& a : node.attributes()) {
            const std::string_view name = a.name();
            if (name == "name") continue;
            if (std::find(element.attributes.begin(), element.attributes.end(), name) ==
                element.attributes.end()) {
                property.place.fail("unknown attribute '" + std::string(name) + "' of <" +
                                    node.name() + ">");
            }
            property.attributes[a.name()] = expanded(property.place, a.value());
        }
        return property;
    }

    void read_object(const pugi::xml_node& node, Object& parent, int depth) {
        Object& object = document_.objects.emplace_back();
        object.tag = node.name();
        object.type = attribute(node, "type");
        object.id = attribute(node, "id");
        object.place = place_of(node);
        parent.children.push_back({.name = version_3_spelling(attribute(node, "name")),
                                   .ref = "",
                                   .place = object.place,
                                   .object = &object});
        if (!object.id.empty() && !ids_.try_emplace(object.id, &object).second) {
            object.fail("the id '" + object.id + "' is taken");
        }
        for (const pugi::xml_node& child : node.children()) read_node(child, object, depth + 1);
    }

    void resolve(Object& object) {
        for (Object::Child& child : object.children) {
            if (child.object != nullptr) continue;
            const auto found = ids_.find(child.ref);
            if (found == ids_.end()) child.place.fail("unknown id '" + child.ref + "'");
            child.object = found->second;
        }
    }

    // Levels of objects in an object. Objects that refer to each other in a circle have no end.
    int height_of(const Object& object, int depth) {
        if (depth > kMaxNesting) object.fail("objects are nested too deeply");
        const auto [known, is_new] = heights_.try_emplace(&object, kUnfinished);
        if (!is_new && known->second == kUnfinished) object.fail("refers to itself");
        if (!is_new) return known->second;
        int height = 0;
        for (const Object::Child& child : object.children) {
            height = std::max(height, height_of(*child.object, depth + 1) + 1);
        }
        if (height > kMaxNesting) object.fail("objects are nested too deeply");
        heights_[&object] = height;
        return height;
    }

    fs::path folder_;
    const Source* source_ = nullptr;
    int n_open_includes_ = 0;
    std::map<std::string, std::string> parameters_;
    std::map<std::string, Object*> ids_;
    static constexpr int kUnfinished = -1;
    std::map<const Object*, int> heights_;
    Document document_;
};

}  // namespace

Document read_document(const fs::path& file) { return Reader(file).take(); }

}  // namespace misbench::mitsuba
