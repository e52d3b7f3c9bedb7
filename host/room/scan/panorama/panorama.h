// SPDX-License-Identifier: Apache-2.0
// The views of a sweep fused into one picture of all directions around the pan-tilt unit.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hal/base/half.h"
#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/pose.h"
#include "host/math/geometry/vignetting.h"

namespace mixrig::model {

/// A view of the head: its frames averaged.
struct ScanView {
  geometry::Pose base_from_tof, base_from_target;
  Image<float> distance_m;  ///< along the ray of each ToF pixel; 0 = unknown
  Image<float> sigma_m;     ///< of distance_m
  Image<Rgb8> plate;        ///< distorted, of the target camera
  /// Picture at another exposure. `exposure`: its exposure time over that of `plate`.
  struct Bracket {
    double exposure = 1;
    Image<Rgb8> plate;
  };
  std::vector<Bracket> brackets{};
  Image<RgbHalf> light{};  ///< as `plate`, linear, 1 = its white (view_light.h); may be empty
  float light_limit = 0;   ///< a channel of `light` that reaches it is a lower limit
};

/// Averages the depth of a view's frames, each weighted by the square of its amplitude, which is
/// the inverse of its variance (Schiller et al. 2010, section 3). Where frames saw several
/// surfaces, farther apart than noise, the surface that most frames saw counts, and of equally
/// frequent ones the farthest, since people who walk through stand before the room. Where no
/// surface was seen twice, all values are averaged: they may be noise. A fifth surface is left out.
/// Not thread-safe.
class ViewAverage {
 public:
  /// `depth_is_distance`: depth is along the ray, not along z.
  ViewAverage(const geometry::CameraModel& tof, const geometry::DepthNoise& noise,
              bool depth_is_distance);

  void clear();
  /// Pictures of the camera's size; `amplitude` may be empty. Unknown depth (0, negative, not
  /// finite) is left out.
  void add(ImageView<const float> depth_m, ImageView<const float> amplitude);
  void finish(Image<float>& distance_m, Image<float>& sigma_m) const;

 private:
  geometry::DepthNoise noise_;
  Image<float> ray_;  ///< distance per depth; 0 where the lens has no ray
  Image<float> z_of_distance_;
  struct Surface {
    float sum_m = 0, weight = 0;
    int count = 0;

    float mean_m() const { return sum_m / weight; }
  };
  using Surfaces = std::array<Surface, 4>;
  void add(float distance_m, float weight, float gap_m, Surfaces& to) const;
  static Surface most_seen(const Surfaces& all);

  Image<Surfaces> surfaces_;
};

/// A large plane of the room: points p in base axes with inverse_per_m . p = 1. The origin does not
/// lie on it.
struct RoomPlane {
  Eigen::Vector3d inverse_per_m;  ///< unit normal over distance from the origin
  double solid_angle_sr = 0;      ///< solid angle of the pixels that were found on it

  /// Distance along a unit ray; 0 where the ray does not meet it.
  double distance_m(const Eigen::Vector3d& ray) const {
    const double w = inverse_per_m.dot(ray);
    return w > 0 ? 1 / w : 0;
  }
};

/// A part of the room: its direction and size.
struct RoomArea {
  Eigen::Vector3d direction;  ///< unit vector to its middle
  double solid_angle_sr = 0;
};

/// Corrections that make the pictures of all views equally bright (view_gains.h).
struct ViewGains {
  std::vector<Eigen::Array3f> gains;  ///< of each view, for linear red, green, blue
  geometry::Vignetting vignetting;    ///< of the target camera
  int samples = 0;                    ///< held-out pairs of views that see the same place
  /// Robust root mean square differences of the held-out pairs, without and with the corrections.
  double before_pct = 0, after_pct = 0;
};

/// Equirectangular picture from the origin of the unit's base (z up along the pan axis, x along the
/// tilt axis, y ahead). Column x is at azimuth pi - 2 pi (x + 0.5) / width, counter-clockwise from
/// ahead as pan is; row y at elevation pi/2 - pi (y + 0.5) / height.
struct Panorama {
  Image<float> distance_m;  ///< from the origin; 0 = unknown
  Image<float> sigma_m;     ///< of distance_m; in filled pixels that of their neighbours, increased
  Image<std::uint8_t> views;  ///< number of views that agree on distance_m; 0: filled or unknown
  Image<std::uint8_t> field;  ///< 1 where a view's frustum is
  Image<Rgb8> color;          ///< sRGB; black = unknown; 1 to 8 times as many pixels a side
  Image<RgbHalf> light{};     ///< as `color`, linear and above 1; empty where no view has light
  Image<std::uint8_t> light_saturated{};  ///< 1 where `light` is a lower limit
  double measured_share = 0;              ///< of the field's solid angle, before holes are filled
  double known_share = 0;                 ///< share after holes are filled
  std::vector<RoomPlane> planes{};        ///< planes it was straightened to, the largest first
  std::vector<RoomArea> wrapped{};        ///< wrapped depth of mirrors, which was left out
  std::vector<RoomArea> flat_holes{};     ///< holes in a wall, which got its depth
  ViewGains gains{};                      ///< gains of its colour

  Size size() const { return distance_m.size(); }
};

/// Whether neighbours at these distances, the lower first, belong to two surfaces.
bool is_depth_step(float low_m, float high_m);

/// Unit direction of a pixel in base axes.
Eigen::Vector3d direction_of(Size panorama, int x, int y);

/// Fast direction_of() for all pixels of a size: from sines and cosines of columns and rows.
class Directions {
 public:
  explicit Directions(Size panorama);
  Eigen::Vector3d operator()(int x, int y) const {
    const Eigen::Vector2d &column = columns_[static_cast<std::size_t>(x)],
                          &row = rows_[static_cast<std::size_t>(y)];
    return {row.x() * column.x(), row.x() * column.y(), row.y()};
  }
  /// Width of a pixel of row y over that of one on the horizon.
  double across(int y) const { return rows_[static_cast<std::size_t>(y)].x(); }

 private:
  std::vector<Eigen::Vector2d> columns_, rows_;
};

/// Height of a panorama (even; its width is twice that), and the steps that are done.
struct PanoramaOptions {
  int height_px = 720;
  bool smooth = true;
  bool straighten = true;
  bool equalise = true;
};

/// Fuses the views. On each ray of the panorama it looks for the surface in each view: the point on
/// the ray that the view measures at its own pixel, found by fixed-point steps from the ray's
/// distance to the view's (the camera is centimetres from the origin, the room metres). Values of
/// several views are averaged with weights 1/sigma^2 times the cosine of incidence, falling to the
/// picture's border. Where views disagree, the distance that most of them see counts, and of
/// equally frequent ones the farthest, since what moved stood before the room. Small holes are
/// filled from their border.
/// `smooth` averages the inverse distances of pixels within 3 pixels in elevation, in pairs
/// opposite each other, where a pair agrees with the pixel to three sigma. `straighten` moves
/// surfaces on large planes onto them (room_planes.h), and makes unknown what floats before them
/// with the scatter of depth that wrapped around. `equalise` removes differences of the views'
/// exposures and the darkening of the lens's corners (view_gains.h).
Panorama make_panorama(std::span<const ScanView> views, const geometry::CameraModel& tof,
                       const geometry::CameraModel& target, const PanoramaOptions& options,
                       Crew& crew);

}  // namespace mixrig::model
