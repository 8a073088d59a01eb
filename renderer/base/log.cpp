#include "renderer/base/log.h"

#include <spdlog/sinks/stdout_sinks.h>

#include "renderer/base/error.h"

namespace misbench {

void init_log(const std::string& program, const std::string& level) {
    const auto parsed = spdlog::level::from_str(level);
    if (parsed == spdlog::level::off && level != "off") {
        throw Error(Errc::InvalidArgument, "unknown log level '" + level +
                                               "'; known: debug info warning error critical off");
    }
    auto logger = std::make_shared<spdlog::logger>(
        program, std::make_shared<spdlog::sinks::stderr_sink_mt>());
    logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e %n[%P] %l %v");
    logger->set_level(parsed);
    logger->flush_on(spdlog::level::info);
    spdlog::set_default_logger(std::move(logger));
}

}  // namespace misbench
