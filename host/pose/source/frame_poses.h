// SPDX-License-Identifier: Apache-2.0
// The pose that each frame is composited with, also where its source has none.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/capture/capture/pose_source.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::pose {

/// What virtual objects do while the pose is lost.
enum class WhenLost : std::uint8_t { kFreeze, kHide };

struct FramePoseOptions {
  double max_age_s = 0.1;  ///< an older pose is lost
  WhenLost when_lost = WhenLost::kFreeze;
};

/// `camera.world_from_target` is what to composite with, lost or not: the last pose that was known,
/// the identity before the first. A lost pose has neither covariance nor age.
struct FramePose {
  capture::CameraPose camera;
  bool objects_shown = true;
};

struct FramePoseCounts {
  std::array<std::uint64_t, capture::kPoseLosses> frames{};  ///< by PoseLoss
  std::uint64_t jumps = 0;  ///< between successive frames with a pose: faster than a camera moves
  std::uint64_t lost() const;
};

/// Nothing allocates. One thread. The source must outlive it.
class FramePoses {
 public:
  FramePoses(capture::PoseSource& source, FramePoseOptions options)
      : source_(source), options_(options) {}
  /// Objects are hidden in a frame without a pose where the options say so, and always before the
  /// first pose: there is no place for them yet.
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
