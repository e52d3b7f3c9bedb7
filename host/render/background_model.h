// SPDX-License-Identifier: Apache-2.0
// What both back ends need of a background that is redrawn for each pose: its depth as a coarse
// grid, which is drawn as the ToF grid is, and its normals.
#pragma once

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/compositor.h"
#include "host/render/prepare.h"

namespace mixrig::render {

/// Built once. The model camera is that of BackgroundModel; all images but the grid's have its
/// size.
struct ModelTables {
  int step_px = 1;             ///< model pixels between samples of the grid
  Tables grid;                 ///< of passes correct and warp; warp.camera_from_tof is left out
  Image<float> depth_m;        ///< of the grid: median of the known depths around, 0 unknown
  PinholeParams camera;        ///< model camera
  Image<float> w;              ///< inverse depth, 0 unknown
  Image<PackedNormal> normal;  ///< model axes
  int limit_radius_px = 1;     ///< of the key's limit in the view
};

/// The grid has as many samples as the ToF camera could tell apart. Without normals `normal` is
/// empty. Precondition: validate(setup) holds and setup.background_model is there.
ModelTables make_model_tables(const CompositorSetup& setup, bool with_normals);

/// The model camera and that of a frame.
struct ModelPose {
  glm::mat4 camera_from_model{1}, model_from_camera{1};
};
ModelPose model_pose(const geometry::Pose& world_from_model,
                     const geometry::Pose& world_from_camera);

}  // namespace mixrig::render
