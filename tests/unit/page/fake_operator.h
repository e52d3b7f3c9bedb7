// SPDX-License-Identifier: Apache-2.0
// A fake run that records what is requested.
#pragma once

#include <condition_variable>
#include <mutex>
#include <vector>

#include "host/operator/page/operator.h"

namespace mixrig::page {

class FakeOperator final : public Operator {
 public:
  State state() const override {
    const std::lock_guard lock(mutex_);
    return state_;
  }
  Result<void> apply(const Command& command) override {
    std::unique_lock lock(mutex_);
    commands_.push_back(command);
    if (const auto* add = std::get_if<AddObject>(&command))
      upload_bytes_ = std::filesystem::file_size(add->glb);
    if (std::holds_alternative<LearnBackground>(command)) return refuse_;
    if (const auto* set = std::get_if<SetLamp>(&command)) state_.lamps[0].on = *set->on;
    return {};
  }
  Result<Image<Rgb8>> take_picture(const std::string& take, int frame) override {
    if (take == "slow") {
      std::unique_lock lock(mutex_);
      ++slow_pictures_;
      changed_.notify_all();
      changed_.wait(lock, [&] { return !holds_pictures_; });
      return Image<Rgb8>({16, 8}, {10, 200, 10});
    }
    if (take == "take 1" && frame <= 3) return Image<Rgb8>({16, 8}, {200, 10, 10});
    return Error{ErrorCode::kNotFound, "there is no frame " + std::to_string(frame)};
  }
  std::vector<Command> commands() const {
    const std::lock_guard lock(mutex_);
    return commands_;
  }
  /// Until the lock ends, state() waits, and with it the server's thread.
  std::unique_lock<std::mutex> hold() const { return std::unique_lock(mutex_); }
  void set(const State& state) {
    const std::lock_guard lock(mutex_);
    state_ = state;
  }
  /// Waits until take_picture() was called for the take "slow", which waits until release().
  void wait_for_slow_picture() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return slow_pictures_ > 0; });
  }
  void release() {
    const std::lock_guard lock(mutex_);
    holds_pictures_ = false;
    changed_.notify_all();
  }
  std::uintmax_t upload_bytes() const {
    const std::lock_guard lock(mutex_);
    return upload_bytes_;
  }

 private:
  const Result<void> refuse_ = Error{ErrorCode::kUnsupported, "this run has no background"};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool holds_pictures_ = true;
  int slow_pictures_ = 0;
  State state_;
  std::vector<Command> commands_;
  std::uintmax_t upload_bytes_ = 0;
};

}  // namespace mixrig::page
