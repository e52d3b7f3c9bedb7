// SPDX-License-Identifier: Apache-2.0
#include "hal/base/log.h"

#include <memory>
#include <thread>

#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "hal/base/clock.h"
#include "hal/base/recent_log.h"

namespace mixrig {
namespace {

spdlog::level::level_enum to_spdlog(LogLevel level) {
  return level == LogLevel::kInfo ? spdlog::level::info : spdlog::level::warn;
}

constexpr std::size_t kRecentLines = 50;

spdlog::sinks::ringbuffer_sink_mt& recent_sink() {
  static const auto instance = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(kRecentLines);
  return *instance;
}

spdlog::logger& logger() {
  static const auto instance = [] {
    auto made = spdlog::stderr_color_mt("mixrig");
    // The sink lives as long as the program.
    made->sinks().push_back(spdlog::sink_ptr(&recent_sink(), [](spdlog::sinks::sink*) {}));
    made->set_pattern("%^%l%$ %v");
    made->set_level(spdlog::level::warn);
    return made;
  }();
  return *instance;
}

}  // namespace

void set_log_level(LogLevel level) { logger().set_level(to_spdlog(level)); }

void log(LogLevel level, std::string_view category, std::string_view message) {
  logger().log(to_spdlog(level), "{}: {}", category, message);
}

std::vector<std::string> recent_log_lines() {
  std::vector<std::string> lines = recent_sink().last_formatted(kRecentLines);
  for (std::string& line : lines)
    while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.pop_back();
  return lines;
}

void SystemClock::sleep_until(HostTime until) {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(until.time_since_epoch())));
}

}  // namespace mixrig
