// SPDX-License-Identifier: Apache-2.0
// Colour pictures with dense disparity: depth of an eighth of the size, made as large as the
// colour.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/judge/bench/suite.h"
#include "host/run/session/session.h"

namespace mixrig::bench {

struct Pair {
  std::string name;
  Image<Rgb8> color;
  Image<float> disparity;  ///< px of the stereo pair, 0 unknown; of the same size
};

/// Middlebury's art, aloe and motorcycle: DIR/art/color.png and disparity.png, DIR/aloe/aloeL.jpg
/// and aloeGT.png, DIR/motorcycle/motorcycle_left.png and disp_x256.png. Errors: of reading; kData
/// where the sizes differ.
Result<std::vector<Pair>> read_pairs(const std::filesystem::path& folder);

/// Every `factor`-th value, from the middle of the blocks.
Image<float> decimated(const Image<float>& values, int factor);

/// `low`, decimated by 8, made as large as `color` by render::depth_at_color_edges: what the
/// compositor does to the learned depth of a room.
Image<float> sides_by_color(const Image<float>& low, const Image<Rgb8>& color);

/// A row for each pair and method: ms of one thread, rms_px, mae_px and wrong_pct (unknown or off
/// by more than 3 px) over the pixels with a true disparity. Ours are the compositor's passes
/// correct and warp, and sides_by_color(). Errors: of reading, of the compositor.
Result<Suite> run_pairs(const std::filesystem::path& folder, bool grid, bool quick,
                        const ProgressFn& progress);

}  // namespace mixrig::bench
