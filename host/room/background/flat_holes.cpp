// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/flat_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "host/math/estimation/points/plane_fit.h"

namespace mixrig::model {
namespace {

constexpr double kLeastHole = 0.002, kMostHole = 0.5;  ///< of the picture
/// Standard deviation of depth beside a hole, relative to it: samples there are mixed.
constexpr double kBesidePart = 0.005;

struct Pixel {
  int x, y;
};

struct Hole {
  std::vector<Pixel> pixels;
  std::vector<Eigen::Vector3d> beside_m;  ///< points of the known pixels beside it
  bool leaves_view = false;
};

class Holes {
 public:
  Holes(ImageView<const float> depth_m, const geometry::Pinhole& view)
      : depth_m_(depth_m), view_(view), seen_(depth_m.size, 0) {}

  /// The hole of a pixel that none returned before has; empty without one.
  Hole of(Pixel first) {
    Hole hole;
    take(first, hole);
    for (std::size_t i = 0; i < hole.pixels.size(); ++i) {
      const auto [x, y] = hole.pixels[i];
      for (const Pixel next : {Pixel{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}})
        take(next, hole);
    }
    return hole;
  }

 private:
  void take(Pixel at, Hole& hole) {
    const Size size = depth_m_.size;
    if (at.x < 0 || at.y < 0 || at.x >= size.width || at.y >= size.height) {
      hole.leaves_view = true;
      return;
    }
    if (const float z_m = depth_m_.row(at.y)[at.x]; z_m > 0) {
      const Eigen::Vector2d ray = view_.unproject({at.x, at.y});
      hole.beside_m.emplace_back(z_m * ray.x(), z_m * ray.y(), z_m);
      return;
    }
    if (!std::exchange(seen_.at(at.x, at.y), std::uint8_t{1})) hole.pixels.push_back(at);
  }

  const ImageView<const float> depth_m_;
  const geometry::Pinhole view_;
  Image<std::uint8_t> seen_;
};

void fill(const Hole& hole, const geometry::Pinhole& view, Image<float>& out) {
  double beside_m = 0;
  for (const Eigen::Vector3d& p : hole.beside_m) beside_m += p.z();
  beside_m /= static_cast<double>(hole.beside_m.size());
  const auto fit = estimation::fit_plane_robust(hole.beside_m, kBesidePart * beside_m);
  if (!fit.usable()) return;
  const geometry::Plane& plane = fit.value.plane;
  for (const auto [x, y] : hole.pixels) {
    const Eigen::Vector2d ray = view.unproject({x, y});
    const double z_m = -plane.offset_m / plane.normal.dot(Eigen::Vector3d(ray.x(), ray.y(), 1));
    if (z_m > 0 && std::isfinite(z_m)) out.row(y)[x] = static_cast<float>(z_m);
  }
}

}  // namespace

Image<float> with_flat_holes(ImageView<const float> depth_m, const geometry::Pinhole& view) {
  Image<float> out(depth_m.size);
  for (int y = 0; y < out.height(); ++y) std::copy_n(depth_m.row(y), out.width(), out.row(y));
  const double all = static_cast<double>(out.size().area());
  Holes holes(depth_m, view);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      if (depth_m.row(y)[x] > 0) continue;
      const Hole hole = holes.of({x, y});
      const auto area = static_cast<double>(hole.pixels.size());
      if (!hole.leaves_view && area >= kLeastHole * all && area <= kMostHole * all)
        fill(hole, view, out);
    }
  return out;
}

}  // namespace mixrig::model
