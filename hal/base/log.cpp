// SPDX-License-Identifier: Apache-2.0
#include "hal/base/log.h"

#include <thread>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "hal/base/clock.h"

namespace mixrig {
namespace {

spdlog::level::level_enum to_spdlog(LogLevel level) {
  return level == LogLevel::kInfo ? spdlog::level::info : spdlog::level::warn;
}

spdlog::logger& logger() {
  static const auto instance = [] {
    auto made = spdlog::stderr_color_mt("mixrig");
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

void SystemClock::sleep_until(HostTime until) {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(until.time_since_epoch())));
}

}  // namespace mixrig
