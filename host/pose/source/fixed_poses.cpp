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
  OwnPoses(bool only_recorded, bool moves) : only_recorded_(only_recorded), moves_(moves) {}
  std::string_view name() const override { return only_recorded_ ? "recorded" : "take"; }
  std::string describe() const override {
    return only_recorded_ ? "recorded: the poses of the source's own recording, one a frame"
                          : "given by the source";
  }
  bool moves() const override { return moves_; }
  CameraPose pose_of(const Capture& capture) override {
    if (only_recorded_ && capture.pose_origin != capture::PoseOrigin::kRecorded)
      return CameraPose::lost(PoseLoss::kAbsent);
    CameraPose pose;
    pose.world_from_target = capture.world_from_target;
    return pose;
  }

 private:
  const bool only_recorded_, moves_;
};

class FixedPose final : public capture::PoseSource {
 public:
  FixedPose(const geometry::Pose& world_from_target, std::string name, std::string describe)
      : name_(std::move(name)), describe_(std::move(describe)) {
    pose_.world_from_target = world_from_target;
  }
  std::string_view name() const override { return name_; }
  std::string describe() const override { return describe_; }
  bool moves() const override { return false; }
  CameraPose pose_of(const Capture&) override { return pose_; }

 private:
  CameraPose pose_;
  const std::string name_, describe_;
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
