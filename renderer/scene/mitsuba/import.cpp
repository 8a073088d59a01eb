#include "renderer/scene/mitsuba/import.h"

#include "renderer/scene/mitsuba/document.h"
#include "renderer/scene/mitsuba/emitters.h"
#include "renderer/scene/mitsuba/sensor.h"
#include "renderer/scene/mitsuba/shapes.h"

namespace misbench {
namespace {

using mitsuba::Context;
using mitsuba::Object;

// What an experiment's method decides is only told.
void note_integrator(Context& context, Object& integrator) {
    for (const char* name : {"max_depth", "hide_emitters"}) {
        const mitsuba::Property* property = integrator.find(name);
        if (property == nullptr) continue;
        context.note("integrator '" + integrator.type + "' of the file ignored: " + name + " " +
                     property->attribute("value"));
    }
}

}  // namespace

SceneDescription import_mitsuba(const std::filesystem::path& file) {
    mitsuba::Document document = mitsuba::read_document(file);
    Object& scene = document.scene;
    Context context{.folder = file.parent_path(), .is_old = document.is_old};
    for (Object* integrator : scene.children_of("integrator")) {
        note_integrator(context, *integrator);
    }
    const std::vector<Object*> sensors = scene.children_of("sensor");
    if (sensors.empty()) scene.place.fail("the scene has no sensor");
    if (sensors.size() > 1) context.note("the first of several sensors taken");
    mitsuba::read_sensor(context, *sensors[0]);
    mitsuba::Shapes(context).read(scene.children_of("shape"));
    for (Object* emitter : scene.children_of("emitter")) mitsuba::read_emitter(context, *emitter);
    // Of these, what others refer to has been read.
    for (const char* tag : {"bsdf", "texture", "spectrum"}) scene.children_of(tag);
    scene.expect_all_read();
    return std::move(context.scene);
}

std::vector<std::string> mitsuba_references(const std::filesystem::path& file) {
    return mitsuba::read_document(file).references;
}

}  // namespace misbench
