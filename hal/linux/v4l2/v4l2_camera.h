// SPDX-License-Identifier: Apache-2.0
// Cameras behind V4L2 nodes: `v4l2:/dev/video0`.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/pool.h"
#include "hal/device/camera.h"
#include "hal/device/frame_pool.h"
#include "hal/device/stream_count.h"
#include "hal/linux/v4l2/v4l2_node.h"

namespace mixrig::device {

/// Copies pictures out of the kernel's buffers, so that a slow consumer does not block the kernel's
/// queue. With StreamRequest::lends, frames of one plane of 8-bit samples lie in these buffers
/// instead, as DMABUFs, while enough stay with the kernel; a buffer is queued again when its frame
/// is dropped. All frames stay valid after the camera was unplugged. When the node disappears, the
/// driver looks for it four times a second and restores its settings.
class V4l2Camera final : public Camera {
 public:
  /// Errors: those of V4l2Node::open and choose_mode.
  static Result<std::unique_ptr<V4l2Camera>> open(const std::string& path,
                                                  const StreamRequest& request, Clock& clock);
  ~V4l2Camera() override { stop(); }

  const CameraInfo& info() const override { return info_; }
  Result<void> start(FrameSink sink) override;
  void stop() override;
  Result<void> set(CameraControl control, double value) override;
  Result<double> get(CameraControl control) override;
  StreamHealth health() const override;

 private:
  V4l2Camera(std::string path, const StreamRequest& request, Clock& clock);
  Result<void> set_up();
  void work();
  bool take(const V4l2Picture& picture);
  FramePtr lent(const V4l2Picture& picture, const Frame& frame);
  void come_back();
  const ControlRange* range(CameraControl control) const;

  std::string path_;
  StreamRequest request_;
  Clock& clock_;
  CameraInfo info_;
  V4l2Layout layout_;
  std::optional<FramePool> pool_;
  Pool<LentPicture> lent_;
  FrameSink sink_;
  mutable std::mutex mutex_;  ///< guards node_ against set/get, count_ and settings_
  V4l2Node node_;
  StreamCount count_;
  std::map<CameraControl, double> settings_;
  DriverThread thread_;
};

}  // namespace mixrig::device
