// SPDX-License-Identifier: Apache-2.0
// What both back ends need of a background that is redrawn for each pose: its depth as a coarse
// grid, which is drawn as the ToF grid is, and its normals.
#pragma once

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/compositor.h"
#include "host/render/prepare.h"

namespace mixrig::render {

/// Built once. The model camera is that of BackgroundModel.
struct ModelTables {
  int step_px = 1;             ///< model pixels between samples of the grid
  Image<glm::vec2> ray;        ///< (x/z, y/z) of a sample of the grid in the model camera
  Image<float> depth_m;        ///< of a sample: median of the known depths around it, 0 unknown
  NoiseParams noise;           ///< of a sample
  PinholeParams camera;        ///< model camera
  Image<PackedNormal> normal;  ///< model axes
  float footprint_px = 1;      ///< view pixels that a step of the grid spans, at least 1
};

/// Without normals `normal` is empty. The grid has as many samples as the ToF camera could tell apart. Precondition: validate(setup)
/// holds and setup.background_model is there.
ModelTables make_model_tables(const CompositorSetup& setup, bool with_normals);

}  // namespace mixrig::render
