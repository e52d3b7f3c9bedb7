// SPDX-License-Identifier: Apache-2.0
// The learned empty room: depth and colour in the ideal view of a still camera, or in one wide view
// of a moving camera.
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

/// Learned picture of a room without people. All images have the view's size.
struct StaticBackground {
  geometry::Pinhole view;
  Image<float> depth_m;        ///< median of z of the room's surface, 0 = never measured
  Image<float> depth_sigma_m;  ///< robust sigma of one measurement
  Image<Rgbf> color;           ///< linear, median; red -1 where unknown
  Image<float> color_sigma;    ///< linear, robust sigma of one channel (mean over channels)
  std::optional<geometry::Plane> floor;  ///< camera axes, normal towards the camera
  int frames = 0;
  std::optional<geometry::Pose> world_from_view;  ///< pose at which it was learned, if known
  /// Shares of the view, known after learning only: where something stood before the room in
  /// several frames, and where only things that come and go were measured, so that the room is
  /// unknown.
  double covered_share = 0, unseen_share = 0;
};

/// Whether the frames to learn from have one pose.
enum class Views {
  kSame,  ///< one pose; depth is unknown where less than a third of the frames measured it
  /// Drawn in one view; depth and colour are unknown where less than three frames saw them.
  kDifferent,
};

/// Collects frames of the room, in which people may move. Not thread-safe.
class StaticBackgroundBuilder {
 public:
  /// Keeps at most `max_frames`, spread over those added (memory: about 5 bytes a pixel and frame;
  /// with Views::kDifferent only of the rectangle in which a frame has depth).
  explicit StaticBackgroundBuilder(const geometry::Pinhole& view, int max_frames = 32,
                                   Views views = Views::kSame);
  /// Adds a frame: depth warped into the view (z in metres, 0 unknown) and the plate in the view
  /// (sRGB). Errors: kData for a wrong size.
  Result<void> add(ImageView<const float> depth_m, ImageView<const Rgb8> color);
  /// Computes the background: for each pixel the median and 1.4826 MAD of the depths of the room's
  /// surface (room_surface.h), unknown where less than a third of the frames with nothing before it
  /// measured it, likewise the colour of these frames in linear light, then the floor. Errors:
  /// kData with less than 3 frames or without any known depth.
  Result<StaticBackground> finish();

 private:
  geometry::Pinhole view_;
  int max_frames_;
  Views views_;
  int seen_ = 0;
  /// The part of the view that a frame saw; unknown outside its images.
  struct Kept {
    int x0 = 0, y0 = 0;          ///< place in the view
    Image<std::uint16_t> depth;  ///< units of 0.25 mm
    Image<Rgb8> color;
    bool has(int x, int y) const {
      return x >= x0 && y >= y0 && x - x0 < depth.width() && y - y0 < depth.height();
    }
  };
  std::vector<Kept> kept_;
};

/// Finds the floor: the lowest large plane whose normal is within 45 degrees of the camera's up, by
/// sampling and least squares; nullopt if there is none.
std::optional<geometry::Plane> find_floor(const geometry::Pinhole& view,
                                          ImageView<const float> depth_m);

/// Writes background.toml, depth.exr (Z, sigma), color.exr (R G B, sigma) and preview PNGs into a
/// folder, whole or not at all. Errors: kIo.
Result<void> save(const StaticBackground& background, const std::filesystem::path& folder);
/// Reads a folder written by save(). Errors: kNotFound, kFormat, kData (sizes that disagree).
Result<StaticBackground> load_static_background(const std::filesystem::path& folder);

}  // namespace mixrig::model
