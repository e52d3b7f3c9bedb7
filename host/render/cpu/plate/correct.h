// SPDX-License-Identifier: Apache-2.0
// Pass correct: z of the ToF grid, without flying pixels, smoothed and linked.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Width of the unknown frame around the grids, which saves border checks of neighbours.
inline constexpr int kFrame = 2;

/// The ToF grid between the steps of the pass; pixel (x, y) is stored at (x + kFrame, y + kFrame).
struct TofGrid {
  explicit TofGrid(Size tof_size);
  Image<float> raw_z_m;       ///< 0 unknown, also where a piece is stray
  Image<float> bend_m;        ///< least second difference of raw_z_m along an axis
  Image<float> step_m;        ///< least depth step around a pixel
  Image<float> clean_z_m;     ///< without stray pixels
  Image<float> z_m, w;        ///< smoothed; w = 1/z, 0 unknown
  Image<float> agreed_z_m;    ///< after pass agree, 0 unknown; empty without a second camera
  Image<std::uint8_t> links;  ///< Link bits
};

enum Link : std::uint8_t { kRight = 1, kDown = 2, kDownRight = 4, kDownLeft = 8 };

/// Runs the whole pass: depths and links.
void correct(Crew& crew, const CorrectParams& params, const Image<glm::vec2>& tof_ray,
             ImageView<const float> depth_m, TofGrid& grid);

/// Computes the depths, without links.
void correct_depth(Crew& crew, const CorrectParams& params, const Image<glm::vec2>& tof_ray,
                   ImageView<const float> depth_m, TofGrid& grid);
/// Computes the links between depths `z_m`: grid.z_m or grid.agreed_z_m.
void link_pixels(Crew& crew, const CorrectParams& params, const Image<float>& z_m, TofGrid& grid);

}  // namespace mixrig::render::cpu
