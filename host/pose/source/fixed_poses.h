// SPDX-License-Identifier: Apache-2.0
// Pose sources that need only the captures: each capture's own pose, or one pose for all.
#pragma once

#include <memory>
#include <string>

#include "host/capture/capture/pose_source.h"

namespace mixrig::pose {

/// Makes a source of the captures' own poses. `only_recorded`: captures whose pose does not belong
/// to their own frame have none; otherwise an unknown pose is the identity. `moves`: whether the
/// poses can differ.
std::unique_ptr<capture::PoseSource> make_own_poses(bool only_recorded, bool moves = true);

/// Makes a source that gives `world_from_target` for every capture. `name` and `describe`: texts of
/// the source.
std::unique_ptr<capture::PoseSource> make_fixed_pose(const geometry::Pose& world_from_target,
                                                     std::string name, std::string describe);

}  // namespace mixrig::pose
