// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>

#include <unistd.h>

#include "hal/base/guarded.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr double kFirstLineAfter_s = 0.5, kLineEvery_s = 10;
constexpr int kCells = 30;

double since_s(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// ", 12.3/s, 0:45 left"; empty where the rate is not known yet.
std::string rate_text(int done, int total, double elapsed_s, double seconds_left) {
  if (done <= 0 || elapsed_s < kFirstLineAfter_s) return {};
  const double rate = done / elapsed_s;
  const long left_s = std::lround(seconds_left > 0 ? seconds_left : (total - done) / rate);
  char text[64];
  std::snprintf(text, sizeof text, ", %.3g/s, %ld:%02ld left", rate, left_s / 60, left_s % 60);
  return text;
}

/// When plain lines are due. The bars of a process share it: the first line comes half a second
/// after the first bar began. A service writes none into the journal.
class Lines {
 public:
  bool is_due() {
    const std::lock_guard lock(mutex_);
    const double now_s = since_s(start_);
    if (is_service_ || now_s < due_s_) return false;
    due_s_ = now_s + kLineEvery_s;
    return true;
  }

 private:
  const SteadyClock::time_point start_ = SteadyClock::now();
  const bool is_service_ = std::getenv("NOTIFY_SOCKET") != nullptr;
  std::mutex mutex_;
  double due_s_ = kFirstLineAfter_s;
};
Lines& lines() {
  static Lines shared;
  return shared;
}

/// Waits until a first line is due, or until it shall stop.
void show_first_line(const std::string& what, int steps, const std::stop_token& stop) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any ended;
  ended.wait_for(lock, stop, std::chrono::duration<double>(1.2 * kFirstLineAfter_s),
                 [] { return false; });
  if (!stop.stop_requested() && lines().is_due())
    std::fprintf(stderr, "%s 0/%d\n", what.c_str(), steps);
}

}  // namespace

Progress::Progress(std::string what, int total, bool waits_for_step)
    : what_(std::move(what)),
      total_(std::max(total, 1)),
      shown_(isatty(STDERR_FILENO) == 1),
      start_(SteadyClock::now()) {
  (void)lines();  // its time begins
  if (shown_ || waits_for_step) return;
  // The first step may take long.
  first_line_ = std::jthread([what = what_, steps = total_](const std::stop_token& stop) {
    (void)guarded("progress", [&] { show_first_line(what, steps, stop); });
  });
}

Progress::~Progress() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
}

void Progress::step(int done, double seconds_left) {
  if (!shown_ && !lines().is_due()) return;
  const std::string rate = rate_text(done, total_, since_s(start_), seconds_left);
  if (!shown_)
    return (void)std::fprintf(stderr, "%s %d/%d%s\n", what_.c_str(), done, total_, rate.c_str());
  const auto full = static_cast<std::size_t>(kCells * std::clamp(done, 0, total_) / total_);
  const std::string bar = std::string(full, '#') + std::string(kCells - full, '.');
  std::fprintf(stderr, "\r%s [%s] %d/%d%s\033[K", what_.c_str(), bar.c_str(), done, total_,
               rate.c_str());
  std::fflush(stderr);
}

}  // namespace mixrig::tools
