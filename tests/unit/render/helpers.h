// SPDX-License-Identifier: Apache-2.0
// Small pictures and tables made by hand for the pass tests.
#pragma once

#include <gtest/gtest.h>

#include "host/render/cpu/plate/plate.h"
#include "host/render/tables/prepare.h"
#include "tests/support/image_of.h"

namespace mixrig::test {

/// A linear colour, 0 to 1, in the format of the cpu back end's plate.
inline render::cpu::Rgbx16 linear16(Rgbf c) {
  const auto fixed = [](float v) { return static_cast<std::uint16_t>(65535 * v); };
  return {fixed(c.r), fixed(c.g), fixed(c.b), 0};
}

/// An ideal camera with the centre in the middle of the picture.
inline geometry::CameraModel ideal_camera(Size size, double f_px) {
  geometry::CameraModel camera;
  camera.pinhole = {size, f_px, f_px, 0.5 * (size.width - 1), 0.5 * (size.height - 1)};
  return camera;
}

/// A setup of two ideal cameras at one place, and nothing else.
inline render::CompositorSetup plain_setup(Size view, double view_f_px, Size tof, double tof_f_px) {
  render::CompositorSetup setup;
  setup.target = ideal_camera(view, view_f_px);
  setup.view = setup.target.pinhole;
  setup.tof = ideal_camera(tof, tof_f_px);
  setup.noise = {0.002F, 0.001F, 0.0005F};
  return setup;
}

}  // namespace mixrig::test
