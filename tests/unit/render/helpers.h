// SPDX-License-Identifier: Apache-2.0
// Small pictures and tables made by hand for the pass tests.
#pragma once

#include <gtest/gtest.h>

#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/plate/plate.h"
#include "host/render/tables/prepare.h"

namespace mixrig::test {

template <typename T, typename Make>
Image<T> make_image(Size size, Make&& make) {
  Image<T> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image.at(x, y) = make(x, y);
  return image;
}

/// A linear colour, 0 to 1, as the plate of the CPU holds it.
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

/// A setup of two ideal cameras at the same place and nothing else.
inline render::CompositorSetup plain_setup(Size view, double view_f_px, Size tof, double tof_f_px) {
  render::CompositorSetup setup;
  setup.target = ideal_camera(view, view_f_px);
  setup.view = setup.target.pinhole;
  setup.tof = ideal_camera(tof, tof_f_px);
  setup.noise = {0.002F, 0.001F, 0.0005F};
  return setup;
}

/// Pass correct on a z image of ideal rays.
struct Corrected {
  explicit Corrected(const Image<float>& depth_m, const render::CorrectParams& params = {},
                     double f_px = 100)
      : grid(depth_m.size()) {
    const render::CompositorSetup setup = plain_setup({8, 8}, 8, depth_m.size(), f_px);
    tables = render::make_tables(setup);
    Crew crew(1);
    render::cpu::correct(crew, params, tables.tof_ray, depth_m, grid);
  }
  float z(int x, int y) const {
    return grid.z_m.at(x + render::cpu::kFrame, y + render::cpu::kFrame);
  }
  int links(int x, int y) const {
    return grid.links.at(x + render::cpu::kFrame, y + render::cpu::kFrame);
  }
  render::Tables tables;
  render::cpu::TofGrid grid;
};

}  // namespace mixrig::test
