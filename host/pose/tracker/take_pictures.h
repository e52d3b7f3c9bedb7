// SPDX-License-Identifier: Apache-2.0
// The pictures of one camera of a take, and where the camera truly was.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/capture/capture/capture_source.h"
#include "host/pose/tracker/rig_camera.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::session {

enum class TrackedCamera { kFisheye, kTarget };

/// The camera, from `calibration` or, where that is empty, from what the take says. Errors: kUsage
/// where nothing says where the fisheye is; those of rig_camera.
Result<RigCamera> tracked_camera(TrackedCamera camera, const std::filesystem::path& calibration,
                                 const capture::SourceInfo& info);

/// The picture of a capture and its time on the clock of Capture::time_s; no picture where it has
/// none of its own.
struct TakePicture {
  const Image<Rgb8>* image = nullptr;
  double time_s = 0;
};
TakePicture picture_of(const capture::Capture& capture, TrackedCamera camera);

/// Errors: kData where the picture has another size than the camera was calibrated with.
Result<void> check_size(const TakePicture& picture, const geometry::AnyCamera& camera,
                        const std::filesystem::path& take);

/// True poses by time: of the fisheye from truth/fisheye.tum, of the target camera from poses of
/// the take that are true.
class TruePath {
 public:
  TruePath(TrackedCamera camera, const std::filesystem::path& take, const capture::SourceInfo& info,
           const RigCamera& rig);
  /// world_from_target.
  std::optional<geometry::Pose> at(double time_s, const capture::Capture& capture) const;

 private:
  bool poses_of_frames_;
  std::vector<trajectory::TimedPose> fisheye_;
  geometry::Pose camera_from_target_;
};

}  // namespace mixrig::session
