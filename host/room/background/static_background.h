// SPDX-License-Identifier: Apache-2.0
// The learned empty room: depth and colour in the ideal view of a still camera, or in one wide view
// of a camera that moves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/plane.h"
#include "host/math/geometry/pose.h"

namespace mixrig::model {

/// All images have the view's size.
struct StaticBackground {
  geometry::Pinhole view;
  Image<float> depth_m;        ///< robust centre of z, 0 = never measured
  Image<float> depth_sigma_m;  ///< robust spread of one measurement
  Image<Rgbf> color;           ///< linear, robust centre; red -1 where unknown
  Image<float> color_sigma;    ///< linear, robust spread of one channel (mean over channels)
  std::optional<geometry::Plane> floor;  ///< camera axes, normal towards the camera
  int frames = 0;
  std::optional<geometry::Pose> world_from_view;  ///< where it was learned, if that is known
};

/// Where the frames to learn from were taken.
enum class Views {
  kSame,       ///< one pose: a pixel is unknown where fewer than a third of the frames measured it
  kDifferent,  ///< drawn in one view: where fewer than three did, its colour too
};

/// Collects empty frames; a person who covers a pixel in a minority of them does not
/// matter.
/// Not thread-safe.
class StaticBackgroundBuilder {
 public:
  /// Keeps at most `max_frames`, spread over those added (memory: about 5 bytes a pixel and frame;
  /// of different views only of the rectangle in which a frame has depth).
  explicit StaticBackgroundBuilder(const geometry::Pinhole& view, int max_frames = 32,
                                   Views views = Views::kSame);
  /// Depth warped into the view (z in metres, 0 unknown) and the plate in the view (sRGB).
  /// Errors: kData for a wrong size.
  Result<void> add(ImageView<const float> depth_m, ImageView<const Rgb8> color);
  /// Per pixel: median and 1.4826 MAD of the known depths, unknown where fewer than
  /// a third of the frames measured it; the same for colour in linear light; then the floor.
  /// Errors: kData with fewer than 3 frames or no known depth at all.
  Result<StaticBackground> finish();

 private:
  geometry::Pinhole view_;
  int max_frames_;
  Views views_;
  int seen_ = 0;
  /// What a frame saw of the view: nothing outside of its images.
  struct Kept {
    int x0 = 0, y0 = 0;          ///< of the view
    Image<std::uint16_t> depth;  ///< units of 0.25 mm
    Image<Rgb8> color;
    bool has(int x, int y) const {
      return x >= x0 && y >= y0 && x - x0 < depth.width() && y - y0 < depth.height();
    }
  };
  std::vector<Kept> kept_;
};

/// The floor: the lowest large plane whose normal is within 45 degrees of the camera's up, found
/// by sampling and refined by least squares; nullopt where there is none.
std::optional<geometry::Plane> find_floor(const geometry::Pinhole& view,
                                          ImageView<const float> depth_m);

/// Writes background.toml, depth.exr (Z, sigma), color.exr (R G B, sigma) and preview PNGs into
/// a folder, whole or not at all. Errors: kIo.
Result<void> save(const StaticBackground& background, const std::filesystem::path& folder);
/// Errors: kNotFound, kFormat, kData (sizes that disagree).
Result<StaticBackground> load_static_background(const std::filesystem::path& folder);

}  // namespace mixrig::model
