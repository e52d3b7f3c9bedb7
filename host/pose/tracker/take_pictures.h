// SPDX-License-Identifier: Apache-2.0
// Pictures of one camera of a take, and its true poses.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/capture/capture/capture_source.h"
#include "host/pose/tracker/rig_camera.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::session {

enum class TrackedCamera { kFisheye, kTarget };

/// Reads the camera from `calibration`, or from the take if that is empty. Errors: kUsage if the
/// fisheye's pose is not given; those of rig_camera().
Result<RigCamera> tracked_camera(TrackedCamera camera, const std::filesystem::path& calibration,
                                 const capture::SourceInfo& info);

/// A picture of a capture and its time on the clock of Capture::time_s; null if the capture has no
/// picture of its own.
struct TakePicture {
  const Image<Rgb8>* image = nullptr;
  double time_s = 0;
};
TakePicture picture_of(const capture::Capture& capture, TrackedCamera camera);

/// Checks the size of a picture. Errors: kData if it differs from the size that the camera was
/// calibrated with.
Result<void> check_size(const TakePicture& picture, const geometry::AnyCamera& camera,
                        const std::filesystem::path& take);

/// True poses by time: those of the fisheye from truth/fisheye.tum, those of the target camera from
/// true poses of the take.
class TruePath {
 public:
  TruePath(TrackedCamera camera, const std::filesystem::path& take, const capture::SourceInfo& info,
           const RigCamera& rig);
  /// Returns the true world_from_target.
  std::optional<geometry::Pose> at(double time_s, const capture::Capture& capture) const;

 private:
  bool poses_of_frames_;
  std::vector<trajectory::TimedPose> fisheye_;
  geometry::Pose camera_from_target_;
};

}  // namespace mixrig::session
