// SPDX-License-Identifier: Apache-2.0
// A USB bulk pipe of a ToF camera, filled by a test.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "hal/device/usb_bulk.h"
#include "hal/wire/camera/tof_usb_decoder.h"

namespace mixrig::test {

/// The state shared by the test and the driver's pipe. Thread-safe.
class FakeTofDevice {
 public:
  FakeTofDevice(const device::TofDescription& description, Clock& clock)
      : description_(description), clock_(clock) {}

  /// Delivers one transfer; it is lost unless the driver streams.
  void send(std::vector<std::uint8_t> transfer) {
    const std::lock_guard lock(mutex_);
    if (streaming_ && submitted_) transfers_.push_back(std::move(transfer));
    changed_.notify_all();
  }
  void stall() {
    const std::lock_guard lock(mutex_);
    halted_ = true;
    changed_.notify_all();
  }
  void unplug() {
    const std::lock_guard lock(mutex_);
    plugged_ = streaming_ = submitted_ = false;
    transfers_.clear();
    changed_.notify_all();
  }
  void replug() {
    const std::lock_guard lock(mutex_);
    plugged_ = true;
    back_at_ = clock_.now();
  }
  bool streaming() const {
    const std::lock_guard lock(mutex_);
    return streaming_ && submitted_;
  }
  /// Time from replug() to the start of the stream, on the injected clock.
  Duration recovery() const {
    const std::lock_guard lock(mutex_);
    return streaming_at_ - back_at_;
  }
  int starts() const {
    const std::lock_guard lock(mutex_);
    return starts_;
  }

 private:
  friend class FakeBulk;
  device::TofDescription description_;
  Clock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<std::uint8_t>> transfers_;
  bool plugged_ = true, streaming_ = false, submitted_ = false, halted_ = false;
  int starts_ = 0;
  HostTime back_at_{}, streaming_at_{};
};

/// The driver's end of the pipe.
class FakeBulk final : public device::UsbBulk {
 public:
  explicit FakeBulk(FakeTofDevice& device) : d_(device) {}
  Result<void> open() override {
    const std::lock_guard lock(d_.mutex_);
    if (!d_.plugged_) return gone();
    open_ = true;
    return {};
  }
  void close() override {
    cancel();
    open_ = false;
  }
  Result<std::size_t> request(std::uint8_t request, std::uint16_t value,
                              std::span<std::uint8_t> in) override {
    const std::lock_guard lock(d_.mutex_);
    if (!open_ || !d_.plugged_) return gone();
    if (request == 0x11) {
      d_.streaming_ = value == 1;
      d_.streaming_at_ = d_.clock_.now();
      d_.starts_ += value == 1 ? 1 : 0;
      return std::size_t{0};
    }
    const auto bytes = device::pack_tof_description(d_.description_);
    const std::size_t count = std::min(in.size(), bytes.size());
    std::copy_n(bytes.begin(), count, in.begin());
    return count;
  }
  Result<void> submit() override {
    const std::lock_guard lock(d_.mutex_);
    if (!open_ || !d_.plugged_) return gone();
    d_.submitted_ = true;
    d_.halted_ = false;
    return {};
  }
  void cancel() override {
    const std::lock_guard lock(d_.mutex_);
    d_.submitted_ = false;
    d_.transfers_.clear();
  }
  device::BulkState pump(Duration timeout, const device::BulkSink& sink) override {
    std::unique_lock lock(d_.mutex_);
    d_.changed_.wait_for(lock, timeout,
                         [this] { return !d_.transfers_.empty() || d_.halted_ || !d_.plugged_; });
    while (!d_.transfers_.empty()) {
      const auto transfer = std::move(d_.transfers_.front());
      d_.transfers_.pop_front();
      lock.unlock();
      sink(transfer);
      lock.lock();
    }
    if (!d_.plugged_ || !open_) return device::BulkState::kGone;
    return d_.halted_ ? device::BulkState::kStalled : device::BulkState::kFlowing;
  }

 private:
  static Error gone() { return Error{ErrorCode::kNotFound, "usb:fake: no such device"}; }
  FakeTofDevice& d_;
  bool open_ = false;
};

}  // namespace mixrig::test
