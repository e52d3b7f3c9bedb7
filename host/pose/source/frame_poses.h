// SPDX-License-Identifier: Apache-2.0
// Chooses the pose with which each frame is composited, also if its source gives none.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/capture/capture/pose_source.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::pose {

/// Behaviour of virtual objects while the pose is lost: they keep their last place in the picture,
/// or are hidden.
enum class WhenLost : std::uint8_t { kFreeze, kHide };

struct FramePoseOptions {
  double max_age_s = 0.1;  ///< an older pose is lost
  WhenLost when_lost = WhenLost::kFreeze;
};

/// The pose of a frame. `camera.world_from_target` is what to composite with; if the pose is lost
/// it is the last known pose, before the first one the identity. A lost pose has neither covariance
/// nor age.
struct FramePose {
  capture::CameraPose camera;
  bool objects_shown = true;
};

struct FramePoseCounts {
  std::array<std::uint64_t, capture::kPoseLosses> frames{};  ///< by PoseLoss
  std::uint64_t jumps = 0;  ///< successive poses farther apart than a camera can move
  std::uint64_t lost() const;
};

/// Checks poses and replaces lost ones. Nothing allocates. For one thread. The source must outlive
/// it.
class FramePoses {
 public:
  FramePoses(capture::PoseSource& source, FramePoseOptions options)
      : source_(source), options_(options) {}
  /// Returns the pose of the next frame. In a frame without a pose objects are hidden if the
  /// options say so, and always before the first pose, since they have no place yet.
  FramePose next(const capture::Capture& capture);
  const FramePoseCounts& counts() const { return counts_; }

 private:
  capture::CameraPose checked(const capture::Capture& capture);

  capture::PoseSource& source_;
  const FramePoseOptions options_;
  FramePoseCounts counts_;
  std::optional<trajectory::TimedPose> last_;  ///< t_s: Capture::time_s
};

}  // namespace mixrig::pose
