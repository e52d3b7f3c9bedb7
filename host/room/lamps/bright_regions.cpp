// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/bright_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

#include "hal/base/srgb.h"

namespace mixrig::lights {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kConfidence99 = 2.576;  ///< sigmas
constexpr double kLeastSigma = 2;        ///< grey levels
constexpr int kRingFrom = 3, kRingTo = 5;
constexpr double kShareVariance = 1.0 / 12;  ///< of a border pixel's coverage

struct Place {
  int x = 0, y = 0;
};
constexpr std::array<Place, 4> kSides{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

int least_channel(const Rgb8& c) { return std::min({c.r, c.g, c.b}); }

/// Labels of the picture's pixels: 0 free, else the number of the region.
class RegionMap {
 public:
  RegionMap(ImageView<const Rgb8> picture, bool goes_around)
      : picture_(picture), goes_around_(goes_around), label_(picture.size) {}

  /// The neighbour of a pixel, or none beyond the border.
  std::optional<Place> step(Place at, Place by) const {
    Place to{at.x + by.x, at.y + by.y};
    const int width = picture_.size.width;
    if (goes_around_) to.x = (to.x + width) % width;
    if (to.x < 0 || to.x >= width || to.y < 0 || to.y >= picture_.size.height) return {};
    return to;
  }
  int value(Place at) const { return least_channel(picture_.at(at.x, at.y)); }
  int label(Place at) const { return label_.at(at.x, at.y); }

  /// Adds to `pixels` whatever joins them and has at least that value.
  void grow(int label, double least, std::vector<Place>& pixels) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Place from = pixels[i];
      for (const Place& side : kSides) take(step(from, side), label, least, pixels);
    }
  }
  void take(std::optional<Place> at, int label, double least, std::vector<Place>& pixels) {
    if (!at || label_.at(at->x, at->y) != 0 || value(*at) < least) return;
    label_.at(at->x, at->y) = label;
    pixels.push_back(*at);
  }

 private:
  ImageView<const Rgb8> picture_;
  bool goes_around_;
  Image<std::int32_t> label_;
};

/// The lower end of the 99 % interval of the pixels' values.
double least_of_interval(const RegionMap& map, const std::vector<Place>& pixels) {
  double sum = 0, squares = 0;
  for (const Place& at : pixels) {
    const double v = map.value(at);
    sum += v, squares += v * v;
  }
  const auto n = static_cast<double>(pixels.size());
  const double mean = sum / n, variance = std::max(0.0, squares / n - mean * mean);
  return mean - kConfidence99 * std::max(kLeastSigma, std::sqrt(variance));
}

/// Solid angle of a pixel by the rays of its corners; 0 where one has none.
double solid_angle_of(const RayOfPixel& ray, const Vector2d& px) {
  std::array<Vector3d, 4> corner;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto r = ray(px + Vector2d(i % 2 == 0 ? -0.5 : 0.5, i < 2 ? -0.5 : 0.5));
    if (!r) return 0;
    corner[i] = *r;
  }
  return 0.5 * (corner[3] - corner[0]).cross(corner[2] - corner[1]).norm();
}

/// Upper quartile of the linear light of the pixels kRingFrom to kRingTo steps outside.
double light_around(const RegionMap& map, int label, std::vector<Place> front, Size size,
                    ImageView<const Rgb8> picture) {
  Image<std::uint8_t> reached(size);
  for (const Place& at : front) reached.at(at.x, at.y) = 1;
  std::vector<float> ring;
  for (int step = 1; step <= kRingTo; ++step) {
    std::vector<Place> next;
    for (const Place& from : front)
      for (const Place& side : kSides) {
        const auto at = map.step(from, side);
        if (!at || reached.at(at->x, at->y) != 0 || map.label(*at) == label) continue;
        reached.at(at->x, at->y) = 1;
        next.push_back(*at);
      }
    if (step >= kRingFrom)
      for (const Place& at : next)
        ring.push_back(linear_of_srgb_bytes()[static_cast<std::size_t>(
            least_channel(picture.at(at.x, at.y)))]);
    front = std::move(next);
  }
  if (ring.empty()) return 1;
  const auto quartile = ring.begin() + static_cast<std::ptrdiff_t>(3 * ring.size() / 4);
  std::nth_element(ring.begin(), quartile, ring.end());
  return *quartile;
}

struct Found {
  int label = 0;
  std::vector<Place> pixels;
};

struct Border {
  std::vector<Place> pixels;
  bool cut = false;
};

Border border_of(const RegionMap& map, int label, const std::vector<Place>& pixels,
                 const RayOfPixel& ray) {
  Border border;
  for (const Place& at : pixels) {
    bool outer = false;
    for (const Place& side : kSides) {
      const auto to = map.step(at, side);
      if (!to) border.cut = true;
      if (to && map.label(*to) == label) continue;
      outer = true;
      const Vector2d beyond(at.x + 2 * side.x, at.y + 2 * side.y);
      if (to && !ray(beyond)) border.cut = true;
    }
    if (outer) border.pixels.push_back(at);
  }
  return border;
}

std::optional<BrightRegion> describe(const RegionMap& map, int label,
                                     const std::vector<Place>& pixels, const RayOfPixel& ray,
                                     ImageView<const Rgb8> picture) {
  BrightRegion region;
  region.pixels = static_cast<int>(pixels.size());
  const std::size_t each = 1 + (pixels.size() - 1) / kMostRegionRays;
  Vector3d sum = Vector3d::Zero();
  Vector2d mean = Vector2d::Zero();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Vector2d px(pixels[i].x, pixels[i].y);
    mean += px / static_cast<double>(pixels.size());
    const auto r = ray(px);
    const double sr = r ? solid_angle_of(ray, px) : 0;
    if (!(sr > 0)) {
      region.cut = true;
      continue;
    }
    sum += sr * *r, region.solid_angle_sr += sr;
    if (i % each == 0) region.rays.push_back({*r, sr});
  }
  if (!(sum.norm() > 0) || region.rays.empty()) return {};
  region.centre_px = mean, region.direction = sum.normalized();
  const Border border = border_of(map, label, pixels, ray);
  region.cut = region.cut || border.cut;
  const double pixel_sr = region.solid_angle_sr / region.pixels;
  Matrix3d scatter = Matrix3d::Zero();
  for (const Place& at : border.pixels)
    if (const auto r = ray({at.x, at.y})) {
      const Vector3d arm = *r - region.direction;
      scatter += arm * arm.transpose();
    }
  const Matrix3d across = Matrix3d::Identity() - region.direction * region.direction.transpose();
  const double per = pixel_sr / region.solid_angle_sr;
  // A pixel that is covered in part moves the centre; the smallest region is no better known than
  // a pixel's place.
  region.covariance = across * (kShareVariance * per * per * scatter) * across +
                      kShareVariance * pixel_sr / region.pixels * across;
  region.surround = light_around(map, label, border.pixels, picture.size, picture);
  return region;
}

}  // namespace

std::vector<BrightRegion> find_bright_regions(ImageView<const Rgb8> picture, const RayOfPixel& ray,
                                              const RegionOptions& options) {
  std::vector<BrightRegion> regions;
  if (picture.empty()) return regions;
  RegionMap map(picture, options.goes_around);
  std::vector<Found> found;
  Found next;
  for (int y = 0; y < picture.size.height; ++y)
    for (int x = 0; x < picture.size.width; ++x) {
      if (map.label({x, y}) != 0 || map.value({x, y}) < options.saturation) continue;
      ++next.label, next.pixels.clear();
      map.take(Place{x, y}, next.label, options.saturation, next.pixels);
      map.grow(next.label, options.saturation, next.pixels);
      map.grow(next.label, least_of_interval(map, next.pixels), next.pixels);
      if (next.pixels.size() >= static_cast<std::size_t>(options.least_pixels))
        found.push_back(next);
    }
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.pixels.size() > b.pixels.size();
  });
  for (const Found& f : found) {
    if (regions.size() == options.most) break;
    if (auto region = describe(map, f.label, f.pixels, ray, picture))
      regions.push_back(*std::move(region));
  }
  std::stable_sort(regions.begin(), regions.end(), [](const auto& a, const auto& b) {
    return a.solid_angle_sr > b.solid_angle_sr;
  });
  return regions;
}

}  // namespace mixrig::lights
