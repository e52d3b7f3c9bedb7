// SPDX-License-Identifier: Apache-2.0
// Functions by which a test controls the scripted OpenNI2 driver. The test loads the module by its
// path, as the library does, and calls them.
#pragma once

#include <cstdint>

extern "C" {

/// One USB camera with URI "scripted". Set it before the library is started.
struct ScriptedCamera {
  int width, height;  ///< of the depth picture
  int depth_unit_um;  ///< 1000 or 100
  float fov_rad;      ///< horizontal; vertical by the shape of the picture; 0: not stated
  int color_width, color_height;
  int period_us;  ///< between the stamps of frames
};
void scripted_describe(const ScriptedCamera* camera);
/// Plugs the camera in (1) or out (0).
void scripted_plug(int in);
/// Delivers one frame of each started stream, mirrored while mirroring is on (the initial state).
void scripted_expose(int frame, const std::uint16_t* depth, const std::uint8_t* rgb);
/// Number of started streams.
int scripted_streams();
int scripted_registered();
}
