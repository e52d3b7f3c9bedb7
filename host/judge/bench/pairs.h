// SPDX-License-Identifier: Apache-2.0
// Benchmark of depth upsampling: colour pictures with dense disparity, whose depth is reduced to an
// eighth of the size and enlarged again.
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
  Image<float> disparity;  ///< px of the stereo pair, 0 unknown; size of `color`
};

/// Reads Middlebury's art, aloe and motorcycle: DIR/art/color.png and disparity.png,
/// DIR/aloe/aloeL.jpg and aloeGT.png, DIR/motorcycle/motorcycle_left.png and disp_x256.png. Errors:
/// those of reading; kData where the sizes differ.
Result<std::vector<Pair>> read_pairs(const std::filesystem::path& folder);

/// Every `factor`-th value, from the middle of each block.
Image<float> decimated(const Image<float>& values, int factor);

/// Enlarges `low`, decimated by 8, to the size of `color` by render::depth_at_color_edges, as the
/// compositor does with the learned depth of a room.
Image<float> sides_by_color(const Image<float>& low, const Image<Rgb8>& color);

/// Suite with a row for each pair and method: ms of one thread, rms_px, mae_px and wrong_pct
/// (unknown or off by more than 3 px) over the pixels with a true disparity. Our methods are the
/// compositor's passes correct and warp, and sides_by_color(). Errors: those of reading and of the
/// compositor.
Result<Suite> run_pairs(const std::filesystem::path& folder, bool grid, bool quick,
                        const ProgressFn& progress);

}  // namespace mixrig::bench
