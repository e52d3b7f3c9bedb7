// SPDX-License-Identifier: Apache-2.0
// Poses that need nothing but the captures: those that they bring, and one for all of them.
#pragma once

#include <memory>
#include <string>

#include "host/capture/capture/pose_source.h"

namespace mixrig::pose {

/// The pose that each capture brings. `only_recorded`: captures whose pose is not of their own
/// frame have none; otherwise an unknown pose is the identity. `moves`: whether they can differ.
std::unique_ptr<capture::PoseSource> make_own_poses(bool only_recorded, bool moves = true);

/// `world_from_target` for every capture. `name` and `describe`: texts of the source.
std::unique_ptr<capture::PoseSource> make_fixed_pose(const geometry::Pose& world_from_target,
                                                     std::string name, std::string describe);

}  // namespace mixrig::pose
