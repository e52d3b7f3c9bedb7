// SPDX-License-Identifier: Apache-2.0
// A trigger line whose edges the test produces.
#pragma once

#include <mutex>

#include "hal/device/trigger_input.h"

namespace mixrig::fake {

/// A trigger input for tests. Edges are delivered on the thread that calls edge(). Any thread may
/// call its methods.
class FakeTriggerInput final : public device::TriggerInput {
 public:
  explicit FakeTriggerInput(Clock& clock) : clock_(clock) {}
  Result<void> start(device::EdgeSink sink) override {
    const std::lock_guard lock(mutex_);
    if (sink_) return Error{ErrorCode::kUsage, "fake:line: runs already"};
    sink_ = std::move(sink);
    sequence_ = 0;
    health_.state = device::DeviceState::kStreaming;
    return {};
  }
  void stop() override {
    const std::lock_guard lock(mutex_);
    sink_ = nullptr;
    health_.state = device::DeviceState::kStopped;
  }
  device::StreamHealth health() const override {
    const std::lock_guard lock(mutex_);
    return health_;
  }

  /// Delivers a rising edge stamped with the present time.
  void edge() { edge(clock_.now()); }
  /// Delivers a rising edge stamped `at`.
  void edge(HostTime at) {
    const std::lock_guard lock(mutex_);
    if (!sink_) return;
    ++health_.frames;
    sink_({sequence_++, at});
  }

 private:
  Clock& clock_;
  mutable std::mutex mutex_;
  device::EdgeSink sink_;
  device::StreamHealth health_;
  std::uint64_t sequence_ = 0;
};

}  // namespace mixrig::fake
