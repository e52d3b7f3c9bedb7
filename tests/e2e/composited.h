// SPDX-License-Identifier: Apache-2.0
// A sink that reports which frames were composited, and with which poses.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>

#include "host/output/sink/composite_sink.h"

namespace mixrig::test {

/// Collects the poses of the frames that were composited so far.
class Composited final : public output::CompositeSink {
 public:
  explicit Composited(std::map<int, capture::CameraPose>& poses) : poses_(poses) {}
  std::string_view name() const override { return "composited"; }
  render::OutputMask wanted(int) const override { return render::kMatte; }
  Result<void> write(const output::CompositePtr& composite) override {
    const std::lock_guard lock(mutex_);
    poses_[composite->capture->number] = composite->pose;
    last_ = composite->capture->number, ++count_;
    changed_.notify_all();
    return {};
  }
  Result<void> finish() override { return {}; }
  std::uint64_t count() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }
  /// Waits until frame `number` was composited; false after two minutes.
  bool wait_for(int number) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(2), [&] { return last_ >= number; });
  }

 private:
  std::map<int, capture::CameraPose>& poses_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int last_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace mixrig::test
