// SPDX-License-Identifier: Apache-2.0
// Plays recorded or rendered frames as if cameras delivered them live.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/device/depth_camera.h"
#include "hal/device/frame_pool.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/live/play/played_head.h"
#include "host/capture/live/play/steered_head.h"

namespace mixrig::live {

/// Plays the colour camera, depth camera, fisheye and head of one recording. Colour and depth come
/// at the time of their frame, with one counter (the frame's number) and one stamp (when it was
/// due); the fisheye's pictures at their own times, with the counters of the recording. It plays
/// from the first frame on as soon as all cameras that were taken from it have started, but not
/// before the time that play_at() sets; at the end they are kStopped. Thread-safe.
/// If the source has a head of its own (capture::RenderedHead), the head can be moved. Each frame
/// is rendered when it is due, for the head's angles at that time; frames that are due while
/// another is rendered are lost, and the counter shows it. If the source's exposure can be set
/// (capture::RenderedExposure), the colour camera has that control.
class Player : public std::enable_shared_from_this<Player> {
 public:
  /// Reads the first frame. Errors: those of reading; kData for a recording without frames or rate.
  static Result<std::shared_ptr<Player>> create(std::unique_ptr<capture::CaptureSource> source,
                                                const std::string& uri, Clock& clock);
  ~Player();

  /// Return a camera of the recording; call each of these once at most. The cameras keep the player
  /// alive.
  std::unique_ptr<device::Camera> camera();
  std::unique_ptr<device::DepthCamera> depth();
  /// Returns the second depth camera. Its pictures come with their frames, stamped with their own
  /// mid-exposure. Errors: kData for a recording without a second depth camera.
  Result<std::unique_ptr<device::DepthCamera>> depth2();
  /// Returns the fisheye. Errors: kData for a recording without fisheye pictures in its first two
  /// seconds.
  Result<std::unique_ptr<device::Camera>> fisheye();
  /// Returns the head; if it can be moved, call this once. Errors: kData for a recording whose
  /// first frame has no angles.
  Result<std::unique_ptr<device::PanTilt>> pan_tilt();
  /// Sets the time of the first frame, so that other programs can play in parallel. If the last
  /// camera starts after that time it fails with kUsage. Call it before the first start.
  void play_at(HostTime begin) { play_at_ = begin; }
  const capture::SourceInfo& info() const { return source_->info(); }
  /// Pose of the target camera at a frame, by the frame's counter.
  struct PlayedPose {
    std::uint64_t sequence = 0;
    geometry::Pose world_from_target;
    capture::PoseOrigin origin = capture::PoseOrigin::kUnknown;
  };
  /// Returns the pose of one of the last 64 frames, else that of the first frame. Any thread.
  PlayedPose pose_of(std::uint64_t sequence) const;

 private:
  friend class PlayedCamera;
  /// One camera of the recording.
  struct Channel {
    device::CameraInfo info;
    std::optional<device::FramePool> pool;
    bool taken = false;
    device::FrameSink sink;  ///< empty while the camera is stopped
    device::StreamHealth health;
  };
  Player(std::unique_ptr<capture::CaptureSource> source, Clock& clock);
  void describe(const std::string& uri);
  Result<void> start(Channel& channel, device::FrameSink sink);
  void stop(Channel& channel);
  device::StreamHealth health(const Channel& channel) const;
  void work();
  void work_steered();
  bool publish_both(int number, HostTime due);
  bool publish_fisheye(HostTime at);
  bool publish_in_time(int number, HostTime due);
  bool has_new_fisheye() const;
  Result<void> find_fisheye();
  std::array<Channel*, 4> channels() { return {&color_, &depth_, &depth2_, &fisheye_}; }
  Result<void> read(int number);
  Result<void> read_next(int number);
  void wait_until(HostTime due);
  void publish(Channel& channel, HostTime at, std::uint64_t counter);
  void fill(const Channel& channel, device::FramePool::Draft& draft) const;
  void end(device::DeviceState state);

  std::unique_ptr<capture::CaptureSource> source_;
  Clock& clock_;
  device::DepthInfo depth_info_, depth2_info_;
  capture::Capture capture_;            ///< used only by the thread while it runs
  std::atomic<double> exposure_s_ = 0;  ///< last value of the control
  double first_s_ = 0;                  ///< time of the first frame in the recording
  HostTime begin_{};                    ///< when the first frame is due
  std::optional<HostTime> play_at_;
  std::string uri_;
  std::shared_ptr<PlayedAngles> angles_;   ///< null if the recording has no angles
  std::shared_ptr<SteeredMotion> motion_;  ///< null if the head cannot be moved
  std::thread thread_;
  mutable std::mutex mutex_;  ///< guards the members below
  Channel color_, depth_, depth2_, fisheye_;
  bool stop_ = true;
  PlayedPose first_pose_;
  std::array<PlayedPose, 64> poses_;  ///< by sequence mod 64
};

}  // namespace mixrig::live
