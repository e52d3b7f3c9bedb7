// SPDX-License-Identifier: Apache-2.0
#include "tests/board/bench.h"

#include <array>
#include <thread>

#include <sys/wait.h>

namespace mixrig::board {

bool wait_until(const std::function<bool()>& done, Duration timeout, Duration look) {
  SystemClock clock;
  const HostTime end = clock.now() + timeout;
  while (!done()) {
    if (clock.now() > end) return false;
    clock.sleep_until(clock.now() + look);
  }
  return true;
}

device::FrameSink Frames::sink() {
  return [this](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex_);
    seen_.push_back(
        {frame->sequence, frame->device_time, frame->received, frame->bytes.size(), frame->flags});
    last_ = frame;
    changed_.notify_all();
  };
}

bool Frames::wait_for_more(std::size_t count) {
  std::unique_lock lock(mutex_);
  const std::size_t wanted = seen_.size() + count;
  return changed_.wait_for(lock, kTimeout, [&] { return seen_.size() >= wanted; });
}

std::vector<Frames::Seen> Frames::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

device::FramePtr Frames::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

Ran run(const std::string& command) {
  std::fflush(stdout);
  Ran ran;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return ran;
  std::array<char, 4096> chunk;
  while (const std::size_t got = std::fread(chunk.data(), 1, chunk.size(), pipe))
    ran.text.append(chunk.data(), got);
  const int status = ::pclose(pipe);
  ran.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return ran;
}

}  // namespace mixrig::board
