// SPDX-License-Identifier: Apache-2.0
// Runs the devices of a rig, one thread per device and one that pairs frames, and delivers sets of
// frames.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/base/bounded_queue.h"
#include "hal/base/clock.h"
#include "hal/device/depth_camera.h"
#include "host/capture/capture/source_report.h"
#include "host/capture/live/rig/devices.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/capture/sync/clock_map.h"
#include "host/capture/sync/device_clock.h"
#include "host/capture/sync/edge_ticks.h"
#include "host/capture/sync/frame_set.h"
#include "host/capture/sync/pairing.h"
#include "host/capture/sync/pan_tilt_track.h"

namespace mixrig::live {

/// Frames of one moment, and the angle of the head.
struct LiveSet {
  sync::FrameSet frames;  ///< 0 is the leading camera, then the others, then the depth cameras
  std::optional<device::PanTiltAngles> pan_tilt;  ///< at mid-exposure; empty where unknown
};

using StreamReport = capture::StreamReport;
using SessionReport = capture::SourceReport;

/// Runs a rig. Config, devices and clock must outlive it. Methods are for one thread.
class LiveSession {
 public:
  LiveSession(const RigConfig& config, Devices& devices, Clock& clock);
  ~LiveSession() { stop(); }
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  /// Starts all devices. Errors: those of the devices; devices that had started are stopped.
  Result<void> start();
  /// Stops the devices first, then the threads, in the order of the data. Does nothing when
  /// stopped.
  void stop();
  /// Returns the next set; empty if none came in time. When a set comes and two wait already (with
  /// a head three), the oldest is dropped. A set whose angle is not known yet (the head moves) is
  /// held until it is, but not longer than 155 ms after its mid-exposure (kHeadPatience).
  std::optional<LiveSet> next(Duration timeout) { return sets_.pop(timeout); }
  /// Moves the head, between two of its answers, and returns when it has accepted the command.
  /// Errors: kUsage if the session does not run or the rig has no head; those of
  /// device::PanTilt::move_to.
  Result<void> move_head(device::PanTiltAngles target);
  /// Stops both axes. Errors: those of move_head().
  Result<void> halt_head();
  /// Whether all cameras have ended by themselves (end of a recording, a failed device) and all
  /// their frames were paired: next() then delivers the remaining sets, then none.
  /// True also after a fault().
  bool ended() const;
  /// What a thread of the session threw; the devices may still run, but no more sets are made.
  Result<void> fault() const;
  SessionReport report() const;

 private:
  struct Event {
    enum class Kind { kNone, kTick, kTickRestart, kEdge, kFrame } kind = Kind::kNone;
    sync::Tick tick;  ///< for an edge only the time is set
    std::size_t stream = 0;
    device::FramePtr frame;
  };
  struct Stream {
    const CameraConfig* config = nullptr;
    device::StampClock stamp_clock = device::StampClock::kNone;
    double rate_hz = 0;
    bool fired = false;  ///< the tick that triggers a frame is known
    sync::FramePairer pairer{{}};
    sync::DeviceClock clock;
    int doubts = 0;  ///< frames in a row whose clock was doubted
    std::uint64_t paired = 0;
    double residual_sum_s = 0, residual_square_s2 = 0;
  };
  static constexpr std::size_t kEvents = 64, kSets = 2, kHeld = 4;

  void fail(const Error& error);
  void push(Event event);
  std::uint64_t waiting_events() const;
  void add_stream(const CameraConfig& config, const device::CameraInfo& info);
  sync::Join join_of(const Stream& stream) const;
  double period_ticks(const Stream& stream) const;
  std::optional<sync::EdgeTicks> make_edges() const;
  sync::StreamTiming timing_of(const CameraConfig& config) const;
  bool has_ticks() const { return devices_.trigger || edges_; }
  Result<void> start_trigger();
  Result<void> start_cameras();
  void run_trigger();
  bool follow_trigger(HostTime& next_status);
  void run_pan_tilt();
  struct HeadCommand {
    bool halt = false;
    device::PanTiltAngles target;
  };
  Result<void> command_head(const HeadCommand& command);
  void obey_head_command();
  void run_sync();
  void on_event(const Event& event);
  void on_tick(const sync::Tick& tick);
  void on_edge(HostTime at);
  void on_restart();
  void on_frame(const Event& event);
  static void count_clock_doubt(Stream& stream, bool doubted);
  HostTime stamp_of(Stream& stream, const device::Frame& frame);
  void emit(const sync::FrameSet& set);
  void release(Duration patience, std::size_t most);

  const RigConfig& config_;
  Devices& devices_;
  Clock& clock_;
  BoundedQueue<Event, kEvents> events_;
  BoundedQueue<LiveSet, kSets + kHeld> sets_;
  std::thread trigger_thread_, pan_tilt_thread_, sync_thread_;
  std::atomic<bool> stop_ = false;
  std::atomic<std::uint64_t> pushed_ = 0, handled_ = 0, held_count_ = 0;
  bool running_ = false;

  mutable std::mutex mutex_;  ///< guards the members below
  std::vector<Stream> streams_;
  sync::TickHistory ticks_{std::chrono::milliseconds(10)};
  std::optional<sync::EdgeTicks> edges_;
  bool newest_from_edge_ = false;  ///< the newest tick was made from an edge
  std::optional<sync::FrameSetBuilder> builder_;
  sync::ClockMap trigger_clock_;
  sync::PanTiltTrack track_;
  Ring<LiveSet, kHeld> held_;  ///< sets that wait for their angle
  SessionReport counts_;
  std::optional<HeadCommand> head_command_;  ///< waits for the thread of the head
  std::optional<Result<void>> head_answer_;  ///< answer to head_command_
  std::condition_variable head_answered_;
  std::optional<Error> fault_;
};

}  // namespace mixrig::live
