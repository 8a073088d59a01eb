#include "experiments/cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "experiments/report/numbers.h"
#include "renderer/base/log.h"

namespace misbench {
namespace {

constexpr std::chrono::seconds kLogInterval{30};
constexpr std::size_t kUsualWidth = 80;

std::size_t terminal_width() {
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualWidth;
    return size.ws_col;
}

// Cut to `width` columns, which is for text whose characters take one column each.
std::string cut(const std::string& text, std::size_t width) {
    if (display_width(text) <= width) return text;
    std::string cut;
    for (const char c : text) {
        const bool starts_character = (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
        if (starts_character && display_width(cut) + 1 > width) break;
        cut += c;
    }
    return cut;
}

std::int64_t total(const QueueStatus& status) {
    return status.pending + status.leased + status.done + status.failed;
}

// What is worked on longest: the one most likely to be asked about.
std::string current(const QueueStatus& status) {
    const auto longest = std::ranges::max_element(status.running, {}, &QueueStatus::Running::since);
    if (longest == status.running.end()) return "";
    return longest->scene + "/" + longest->method;
}

}  // namespace

ProgressMode progress_mode(const std::string& option) {
    if (option == "never") return ProgressMode::Never;
    if (option == "always") return ProgressMode::Line;
    const char* terminal = std::getenv("TERM");
    const bool is_dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
    return ::isatty(STDERR_FILENO) == 1 && !is_dumb ? ProgressMode::Line : ProgressMode::Log;
}

double RemainingTime::estimate(const QueueStatus& status) {
    for (const std::string& id : status.finished) {
        const auto cost = costs_.find(id);
        if (cost == costs_.end()) continue;
        Scale& scale = cost->second.is_guess ? guessed_ : measured_;
        if (const auto seen = last_seen_.find(id); seen != last_seen_.end()) {
            scale.expected += cost->second.seconds;
            scale.taken += seen->second;
        }
        costs_.erase(cost);
    }
    double left = 0;
    for (const auto& [id, cost] : costs_) left += scaled(cost);
    for (const auto& running : status.running) {
        const double seconds = std::chrono::duration<double>(running.since).count();
        last_seen_[running.task] = seconds;
        const auto cost = costs_.find(running.task);
        if (cost != costs_.end()) left -= std::min(seconds, scaled(cost->second));
    }
    return std::max(0.0, left) / workers_;
}

void Progress::show(const QueueStatus& status, SteadyTime now) {
    const double seconds = remaining_.estimate(status);
    if (mode_ == ProgressMode::Line) {
        const std::string line = fmt::format(
            "{}{}/{} done, {} running, {} failed, ETA {}  {}", label_, status.done, total(status),
            status.leased, status.failed, format_duration(seconds), current(status));
        std::fprintf(stderr, "\r\033[K%s", cut(line, terminal_width() - 1).c_str());
        std::fflush(stderr);
        is_shown_ = true;
    }
    if (mode_ == ProgressMode::Log && now - last_log_ >= kLogInterval) {
        spdlog::info("progress done={} total={} running={} failed={} eta_s={:.0f} now={}",
                     status.done, total(status), status.leased, status.failed, seconds,
                     current(status));
        last_log_ = now;
    }
}

void Progress::finish(const QueueStatus& status) {
    clear();
    if (mode_ == ProgressMode::Never) return;
    spdlog::info("run ended done={} total={} failed={}", status.done, total(status), status.failed);
}

void Progress::clear() {
    if (is_shown_) std::fprintf(stderr, "\r\033[K");
    is_shown_ = false;
}

}  // namespace misbench
