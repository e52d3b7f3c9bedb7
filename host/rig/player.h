// SPDX-License-Identifier: Apache-2.0
// Recorded or rendered frames, played as if cameras delivered them now.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/device/depth_camera.h"
#include "hal/device/frame_pool.h"
#include "host/take/take.h"

namespace mixrig::rig {

/// What there is to play: frames 1..info.frames, read in order on the player's thread.
struct Playable {
  take::TakeInfo info;
  std::function<Result<void>(int number, take::TakeFrame& frame)> read;
};
/// Opens "take:DIR", "studio:WORDS" or the like. Errors: kUsage; those of what it opens.
using PlayableOpener = std::function<Result<Playable>(const std::string& uri)>;

/// A colour and a depth camera of one recording. Both deliver each frame at its time, with one
/// counter (the frame's number) and one stamp (when it was due); it plays once all cameras that
/// were taken from it have started, from the first frame on, and at its end they are kStopped. Any
/// threads.
class Player : public std::enable_shared_from_this<Player> {
 public:
  /// Reads the first frame. Errors: those of reading; kData for a recording without frames or rate.
  static Result<std::shared_ptr<Player>> create(Playable playable, const std::string& uri,
                                                Clock& clock);
  ~Player();

  /// One each. They keep the player alive.
  std::unique_ptr<device::Camera> camera();
  std::unique_ptr<device::DepthCamera> depth();
  const take::TakeInfo& info() const { return playable_.info; }
  /// Of the first frame.
  const geometry::Pose& world_from_target() const { return world_from_target_; }

 private:
  friend class PlayedCamera;
  /// One camera of the recording.
  struct Channel {
    device::CameraInfo info;
    std::optional<device::FramePool> pool;
    bool taken = false;
    device::FrameSink sink;  ///< empty while it is stopped
    device::StreamHealth health;
  };
  Player(Playable playable, Clock& clock);
  void describe(const std::string& uri);
  Result<void> start(Channel& channel, device::FrameSink sink);
  void stop(Channel& channel);
  device::StreamHealth health(const Channel& channel) const;
  void work();
  Result<void> read_next(int number);
  void wait_until(HostTime due);
  void publish(Channel& channel, HostTime at);
  void fill(const Channel& channel, device::FramePool::Draft& draft) const;
  void end(device::DeviceState state);

  Playable playable_;
  Clock& clock_;
  device::DepthInfo depth_info_;
  geometry::Pose world_from_target_;
  take::TakeFrame frame_;  ///< of the thread while it runs
  HostTime begin_{};       ///< of the first frame
  std::thread thread_;
  mutable std::mutex mutex_;  ///< guards what follows
  Channel color_, depth_;
  bool stop_ = true;
};

}  // namespace mixrig::rig
