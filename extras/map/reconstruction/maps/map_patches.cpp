// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/maps/map_patches.h"

#include <algorithm>
#include <cmath>

#include "host/math/estimation/decompositions.h"
#include "host/pose/tracker/grey_pyramid.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using tracking::kPatchPixels;
using tracking::kPatchSide;
using tracking::kWidePatch;

constexpr double kLeastFacing = 0.2;

/// A point as its key picture shows it.
struct Shown {
  const MapPoint* point;
  Vector3d in_camera;
};

/// Normal of the surface around a point, in axes of its camera, towards it.
Vector3d normal_at(const Shown& at, const std::vector<Shown>& shown) {
  const Vector3d across = -at.in_camera.normalized();
  constexpr std::size_t kNeighbours = 8;
  constexpr double kReach_px = 50, kFlat = 0.08;
  std::vector<std::pair<double, const Shown*>> near;
  for (const Shown& s : shown) {
    const double away_px = (s.point->px - at.point->px).norm();
    if (away_px < kReach_px) near.emplace_back(away_px, &s);
  }
  if (near.size() < kNeighbours) return across;
  std::partial_sort(near.begin(), near.begin() + kNeighbours, near.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vector3d> places;
  std::vector<int> indices;
  for (std::size_t i = 0; i < kNeighbours; ++i)
    places.push_back(near[i].second->in_camera), indices.push_back(static_cast<int>(i));
  const estimation::PointSpread spread = estimation::spread_of(places, indices);
  if (!(spread.spread_m[0] < kFlat * spread.spread_m[1])) return across;
  const Vector3d normal = spread.axes.col(0);
  const double facing = normal.dot(across);
  if (std::abs(facing) < 2 * kLeastFacing) return across;
  return facing > 0 ? normal : Vector3d(-normal);
}

float value_at(const Image<float>& image, double x, double y) {
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  if (left < 0 || top < 0 || left + 1 >= image.width() || top + 1 >= image.height()) return -1;
  const auto u = static_cast<float>(x - left), v = static_cast<float>(y - top);
  const float *a = image.row(top) + left, *b = image.row(top + 1) + left;
  return (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
}

/// Makes patches of one key picture.
class Cutter {
 public:
  Cutter(const MapKey& key, const geometry::AnyCamera& camera, const tracking::GreyPyramid& grey)
      : key_(key), camera_(camera), grey_(grey) {}

  /// False where the patch leaves the picture or its plane, or has no contrast.
  bool cut(const Shown& shown, const Vector3d& normal, int level, tracking::Patch& patch) const {
    if (level >= grey_.levels()) return false;
    const double x = tracking::down(shown.point->px.x(), level);
    const double y = tracking::down(shown.point->px.y(), level);
    std::array<float, kWidePatch * kWidePatch> wide{};
    std::array<Vector3d, kPatchPixels> places;
    constexpr double kMiddle = 0.5 * (kWidePatch - 1);
    for (int v = 0; v < kWidePatch; ++v)
      for (int u = 0; u < kWidePatch; ++u) {
        const double at_x = x + u - kMiddle, at_y = y + v - kMiddle;
        const float grey = value_at(grey_.level(level), at_x, at_y);
        if (grey < 0) return false;
        wide[static_cast<std::size_t>(v * kWidePatch + u)] = grey;
        if (u == 0 || v == 0 || u + 1 == kWidePatch || v + 1 == kWidePatch) continue;
        const auto place =
            on_plane(shown.in_camera, normal, tracking::up(at_x, level), tracking::up(at_y, level));
        if (!place) return false;
        places[static_cast<std::size_t>((v - 1) * kPatchSide + u - 1)] =
            key_.map_from_camera * *place;
      }
    patch.share.fill(1);
    const Vector3d eye = key_.map_from_camera.translation_m;
    tracking::set_places(places, eye, patch);
    tracking::set_look(wide, patch);
    patch.range_m = static_cast<float>(shown.in_camera.norm());
    patch.pixel_rad = std::min(patch.u_m.norm(), patch.v_m.norm()) < 1e-9F
                          ? 0
                          : std::sqrt(patch.u_m.norm() * patch.v_m.norm()) / patch.range_m;
    patch.sigma_m = static_cast<float>(std::sqrt(shown.point->covariance.trace() / 3));
    return tracking::has_contrast(patch);
  }

 private:
  std::optional<Vector3d> on_plane(const Vector3d& centre, const Vector3d& normal, double x,
                                   double y) const {
    const auto ray = geometry::unproject(camera_, {x, y});
    if (!ray) return std::nullopt;
    const double facing = -normal.dot(*ray);
    if (facing < kLeastFacing) return std::nullopt;
    const double range = -normal.dot(centre) / facing;
    if (!(range > 0)) return std::nullopt;
    return Vector3d(range * *ray);
  }

  const MapKey& key_;
  const geometry::AnyCamera& camera_;
  const tracking::GreyPyramid& grey_;
};

Image<Rgb8> as_color(const Image<std::uint8_t>& grey) {
  Image<Rgb8> color(grey.size());
  for (int y = 0; y < grey.height(); ++y)
    for (int x = 0; x < grey.width(); ++x) {
      const std::uint8_t v = grey.row(y)[x];
      color.row(y)[x] = {v, v, v};
    }
  return color;
}

}  // namespace

tracking::PatchMap patches_of(const LearnedMap& map, const geometry::AnyCamera& camera,
                              int levels) {
  tracking::PatchMap patches;
  patches.levels.resize(static_cast<std::size_t>(levels));
  std::vector<std::vector<Shown>> shown(map.keys.size());
  for (const MapPoint& p : map.points) {
    const auto key = static_cast<std::size_t>(p.key);
    shown[key].push_back({&p, geometry::inverse(map.keys[key].map_from_camera) * p.place});
  }
  Crew crew(1);
  tracking::GreyPyramid grey;
  for (std::size_t k = 0; k < map.keys.size(); ++k) {
    grey.build(as_color(map.keys[k].grey).view(), levels, crew);
    const Cutter cutter(map.keys[k], camera, grey);
    // Neighbours may have their look from another picture: those of this one are near enough.
    for (const Shown& s : shown[k]) {
      const Vector3d normal = normal_at(s, shown[k]);
      for (int level = 0; level < levels; ++level) {
        tracking::Patch patch;
        if (cutter.cut(s, normal, level, patch))
          patches.levels[static_cast<std::size_t>(level)].push_back(patch);
      }
    }
  }
  return patches;
}

}  // namespace mixrig::reconstruction
