// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/fixed_poses.h"

#include <utility>

namespace mixrig::pose {
namespace {

using capture::CameraPose;
using capture::Capture;
using capture::PoseLoss;

class OwnPoses final : public capture::PoseSource {
 public:
  OwnPoses(bool only_recorded, bool moves)
      : PoseSource({only_recorded ? "recorded" : "take",
                    only_recorded ? "recorded: the poses of the source's own recording, one a frame"
                                  : "given by the source",
                    moves}),
        only_recorded_(only_recorded) {}
  CameraPose pose_of(const Capture& capture) override {
    if (only_recorded_ && capture.pose_origin != capture::PoseOrigin::kRecorded)
      return CameraPose::lost(PoseLoss::kAbsent);
    CameraPose pose;
    pose.world_from_target = capture.world_from_target;
    return pose;
  }

 private:
  const bool only_recorded_;
};

class FixedPose final : public capture::PoseSource {
 public:
  FixedPose(const geometry::Pose& world_from_target, std::string name, std::string describe)
      : PoseSource({std::move(name), std::move(describe), false}) {
    pose_.world_from_target = world_from_target;
  }
  CameraPose pose_of(const Capture&) override { return pose_; }

 private:
  CameraPose pose_;
};

}  // namespace

std::unique_ptr<capture::PoseSource> make_own_poses(bool only_recorded, bool moves) {
  return std::make_unique<OwnPoses>(only_recorded, moves);
}

std::unique_ptr<capture::PoseSource> make_fixed_pose(const geometry::Pose& world_from_target,
                                                     std::string name, std::string describe) {
  return std::make_unique<FixedPose>(world_from_target, std::move(name), std::move(describe));
}

}  // namespace mixrig::pose
