#include "renderer/base/error.h"

namespace misbench {

int exit_code(Errc code) {
    switch (code) {
        case Errc::InvalidArgument:
        case Errc::NotFound:
            return 2;
        case Errc::FailedPrecondition:
        case Errc::DataLoss:
            return 3;
        case Errc::Unavailable:
            return 4;
        case Errc::Internal:
            break;
    }
    return 70;
}

}  // namespace misbench
