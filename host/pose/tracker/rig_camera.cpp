// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/rig_camera.h"

#include <fmt/format.h>

#include "host/capture/calibration_file/calibration.h"

namespace mixrig::session {

Result<RigCamera> rig_camera(const std::filesystem::path& calibration, const std::string& name) {
  MIXRIG_ASSIGN(const calibration_file::Calibration known,
                calibration_file::read_calibration(calibration));
  const auto* camera = known.camera(name);
  const auto* pose = known.pose(name);
  if (camera == nullptr || (name != "target" && pose == nullptr))
    return Error{ErrorCode::kData,
                 fmt::format("{}: holds no camera \"{}\" with its pose in the rig: calibrate it by "
                             "mixrig calibrate intrinsics and mixrig calibrate rig",
                             calibration.string(), name)};
  return RigCamera{camera->model,
                   pose == nullptr ? geometry::Pose{} : geometry::inverse(pose->target_from)};
}

}  // namespace mixrig::session
