// SPDX-License-Identifier: Apache-2.0
// What a test tells the scripted OpenNI2 driver: it loads the module by its path, as the library
// does, and calls these functions of it.
#pragma once

#include <cstdint>

extern "C" {

/// One USB camera, URI "scripted". Before the library is started.
struct ScriptedCamera {
  int width, height;  ///< of depth
  int depth_unit_um;  ///< 1000 or 100
  float fov_rad;      ///< horizontal; vertical by the shape of the picture; 0: not told
  int color_width, color_height;
  int period_us;  ///< between the stamps of frames
};
void scripted_describe(const ScriptedCamera* camera);
/// Plugs it in or out.
void scripted_plug(int in);
/// One frame of each stream that was started, mirrored where mirroring is on (it is at first).
void scripted_expose(int frame, const std::uint16_t* depth, const std::uint8_t* rgb);
/// Streams that are started; whether depth is registered to colour, as it is at first.
int scripted_streams();
int scripted_registered();
}
