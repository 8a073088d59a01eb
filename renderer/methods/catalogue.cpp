#include "renderer/methods/catalogue.h"

#include <array>

#include "renderer/base/names.h"
#include "renderer/methods/bdpt.h"
#include "renderer/methods/direct.h"
#include "renderer/methods/light.h"
#include "renderer/methods/path.h"
#include "renderer/methods/photon.h"
#include "renderer/methods/vcm.h"

namespace misbench {

std::span<const MethodInfo> methods() {
    // To add a method: write its file, include its header above, add its row here.
    static const std::array kMethods = {kPath, kDirect, kLight, kBdpt, kPhoton, kVcm};
    return kMethods;
}

const MethodInfo& find_method(const std::string& name) {
    return find_named(methods(), name, "method", "method");
}

}  // namespace misbench
