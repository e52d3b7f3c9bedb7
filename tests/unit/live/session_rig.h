// SPDX-License-Identifier: Apache-2.0
// A rig of fakes for sessions: a master of 100 Hz, colour and depth at 25 Hz, a slower camera.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "hal/fake/fake_camera.h"
#include "hal/fake/fake_pan_tilt.h"
#include "hal/fake/fake_trigger.h"
#include "hal/fake/fake_trigger_input.h"
#include "host/capture/live/session/live_session.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"

namespace mixrig::live {

using namespace std::chrono_literals;

inline device::CameraInfo fake_info(device::PixelFormat format) {
  return {.uri = "fake:",
          .model = "fake",
          .size = {16, 8},
          .format = format,
          .rate_hz = 25,
          .stamp_clock = device::StampClock::kHost};
}

class Session : public ::testing::Test {
 protected:
  void SetUp() override {
    config_.name = "fake";
    config_.trigger_uri = "fake:trigger";
    config_.lines = {{0, {.divider = 4, .phase = 0ms, .width = 1ms}},
                     {1, {.divider = 10, .phase = 0ms, .width = 1ms}}};
    const auto camera = [](const char* name, int line) {
      CameraConfig c;
      c.name = name;
      c.uri = "fake:";
      c.trigger_line = line;
      return c;
    };
    config_.cameras = {camera("color", 0), camera("side", 1)};
    config_.depth = camera("depth", 0);
    color_ = add(device::PixelFormat::kRgb8, color_stamps_);
    side_ = add(device::PixelFormat::kGray8);
    auto depth =
        std::make_unique<fake::FakeCamera>(clock_, fake_info(device::PixelFormat::kDepth16), 256);
    depth_ = depth.get();
    devices_.depth = device::as_depth_camera(std::move(depth), {});
    auto trigger = std::make_unique<fake::FakeTrigger>(clock_);
    trigger_ = trigger.get();
    devices_.trigger = std::move(trigger);
    session_.emplace(config_, devices_, clock_);
  }
  /// Adds a head that stands still at (0.25, -0.125) rad. Call it before start().
  void add_head() {
    auto head = std::make_unique<fake::FakePanTilt>(clock_);
    head_ = head.get();
    ASSERT_TRUE(head->move_to({0.25, -0.125}));
    clock_.advance(1s);
    devices_.pan_tilt = std::move(head);
  }
  /// Makes this host see the pulses of line 0. Call it before start().
  void add_edges() {
    auto edges = std::make_unique<fake::FakeTriggerInput>(clock_);
    edges_ = edges.get();
    devices_.edges = std::move(edges);
    config_.edges_uri = "fake:line";
    config_.edges_line = 0;
    session_.emplace(config_, devices_, clock_);
  }
  fake::FakeCamera* add(device::PixelFormat format,
                        device::StampClock stamps = device::StampClock::kHost) {
    auto info = fake_info(format);
    info.stamp_clock = stamps;
    devices_.cameras.push_back(std::make_unique<fake::FakeCamera>(clock_, info, 256));
    return static_cast<fake::FakeCamera*>(devices_.cameras.back().get());
  }
  /// Advances the rig by 10 ms. Returns when the pairing thread has processed all events.
  void tick() {
    clock_.advance(10ms);
    if (devices_.pan_tilt) look_at_head();
    const bool runs = trigger_->running();
    const std::uint64_t number = trigger_->tick();
    if (heard_) ++ticked_;
    if (heard_ && awaited_) wait([&] { return session_->report().ticks >= ticked_; });
    if (edges_ != nullptr && runs && number % 4 == 0) edges_->edge(clock_.now() + edge_late_);
    if (number % 4 == 0) {
      color_->emit();
      depth_->emit();
    }
    if (number % 10 == 0) side_->emit();
    wait([&] { return session_->report().waiting_events == 0; });
  }
  /// Waits until the head was queried after the time step: certain after two answers or errors.
  void look_at_head() {
    const auto asked = [this] {
      const SessionReport report = session_->report();
      return report.pan_tilt_samples + report.pan_tilt_errors;
    };
    const std::uint64_t wanted = asked() + 2;
    wait([&] { return asked() >= wanted; });
  }
  template <typename Condition>
  void wait(Condition condition) {
    if (!test::comes_true([&] { return done_ || condition(); })) {
      ADD_FAILURE() << "the session makes no progress";
      done_ = true;
    }
  }
  /// Runs `ticks` ticks and returns their sets; a tick's sets are in the queue when tick() returns.
  std::vector<LiveSet> run(int ticks) {
    std::vector<LiveSet> sets;
    for (int i = 0; i < ticks; ++i) {
      tick();
      while (auto set = session_->next(0ms)) sets.push_back(*std::move(set));
    }
    return sets;
  }

  device::StampClock color_stamps_ = device::StampClock::kHost;
  test::SteppedClock clock_;
  RigConfig config_;
  Devices devices_;
  fake::FakeCamera *color_ = nullptr, *side_ = nullptr, *depth_ = nullptr;
  fake::FakeTrigger* trigger_ = nullptr;
  fake::FakePanTilt* head_ = nullptr;
  fake::FakeTriggerInput* edges_ = nullptr;
  Duration edge_late_{};
  std::uint64_t ticked_ = 0;
  bool heard_ = true;               ///< the session receives the ticks
  bool awaited_ = true;             ///< the test waits for the session to receive them
  std::atomic<bool> done_ = false;  ///< the test is over: waits end at once
  std::optional<LiveSession> session_;
};

}  // namespace mixrig::live
