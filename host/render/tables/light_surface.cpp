// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/light_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/render/tables/depth_planes.h"

namespace mixrig::render {
namespace {

constexpr int kLeastCell_px = 4, kMostCell_px = 16;
constexpr double kOutlier = 4;  // sigmas: limit of a single depth among others on the plane
constexpr double kNormalAngle_rad = 0.1;
constexpr int kMostScale = 8;
/// An object stands on a plane if it is off the plane by less than kMostSunk of the depth and its
/// up direction within 15 degrees of the normal. Multipath light bends depths by up to kBentPart.
constexpr double kMostSunk = 0.05, kBentPart = 0.012, kLeastUpright = 0.966;
/// Metres above the foot at which the plane is put: the floor seen beside an object must not lie
/// below it.
constexpr double kOverFootM = 0.005;

constexpr std::uint8_t kUnknown = 255, kOffPlanes = 254;

/// Plane number of each pixel, kOffPlanes, or kUnknown without depth.
Image<std::uint8_t> plane_of_pixels(ImageView<const float> depth_m, const geometry::Pinhole& view,
                                    const NoiseParams& noise, const Cells& cells,
                                    const std::vector<WPlane>& planes) {
  const std::vector<PlaneSet> near = planes_near(cells, planes);
  Image<std::uint8_t> out(depth_m.size, kUnknown);
  for (int v = 0; v < out.height(); ++v)
    for (int u = 0; u < out.width(); ++u) {
      const float z = depth_m.row(v)[u];
      if (!(z > 0) || !std::isfinite(z)) continue;
      out.row(v)[u] = kOffPlanes;
      const PlaneSet set =
          near[static_cast<std::size_t>(v / cells.side_px * cells.columns + u / cells.side_px)];
      const double w = 1 / static_cast<double>(z), x = (u - view.cx_px) / view.fx_px,
                   y = (v - view.cy_px) / view.fy_px;
      const double most = kOnPlane * sigma_w(noise, w);
      // The larger plane comes first: the noise does not tell which one is nearer.
      for (std::size_t k = 0; k < planes.size() && out.row(v)[u] == kOffPlanes; ++k)
        if ((set >> k & 1U) != 0 && std::abs(w - planes[k].at(x, y)) <= most)
          out.row(v)[u] = static_cast<std::uint8_t>(k);
    }
  return out;
}

/// The plane of more than half of the known pixels within `reach`; kOffPlanes if none has.
std::uint8_t plane_of_most(const Image<std::uint8_t>& plane_of, int u, int v, int reach) {
  std::array<int, kMostPlanes> votes{};
  int known = 0;
  for (int y = std::max(0, v - reach); y <= std::min(plane_of.height() - 1, v + reach); ++y)
    for (int x = std::max(0, u - reach); x <= std::min(plane_of.width() - 1, u + reach); ++x) {
      const std::uint8_t plane = plane_of.row(y)[x];
      known += plane != kUnknown ? 1 : 0;
      if (plane < kMostPlanes) ++votes[plane];
    }
  const auto most = std::max_element(votes.begin(), votes.end());
  return 2 * *most > known ? static_cast<std::uint8_t>(most - votes.begin()) : kOffPlanes;
}

/// Gives single depths that are far off but surrounded by a plane to that plane, as noise.
void join_outliers(ImageView<const float> depth_m, const geometry::Pinhole& view,
                   const NoiseParams& noise, int reach, const std::vector<WPlane>& planes,
                   Image<std::uint8_t>& plane_of) {
  const Image<std::uint8_t> before(plane_of);
  for (int v = 0; v < before.height(); ++v)
    for (int u = 0; u < before.width(); ++u) {
      if (before.row(v)[u] != kOffPlanes) continue;
      const std::uint8_t plane = plane_of_most(before, u, v, reach);
      if (plane == kOffPlanes) continue;
      const double w = 1 / static_cast<double>(depth_m.row(v)[u]);
      const double off =
          w - planes[plane].at((u - view.cx_px) / view.fx_px, (v - view.cy_px) / view.fy_px);
      if (std::abs(off) <= kOutlier * sigma_w(noise, w)) plane_of.row(v)[u] = plane;
    }
}

/// The plane that most of the directions (of eight, at least 3) that meet a known pixel meet first.
std::uint8_t plane_around(const Image<std::uint8_t>& plane_of, int u, int v) {
  constexpr std::array<std::array<int, 2>, 8> kWays{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};
  std::array<int, kMostPlanes> votes{};
  int met = 0;
  for (const auto& [dx, dy] : kWays) {
    int x = u + dx, y = v + dy;
    while (x >= 0 && y >= 0 && x < plane_of.width() && y < plane_of.height() &&
           plane_of.row(y)[x] == kUnknown)
      x += dx, y += dy;
    if (x < 0 || y < 0 || x >= plane_of.width() || y >= plane_of.height()) continue;
    ++met;
    if (plane_of.row(y)[x] < kMostPlanes) ++votes[plane_of.row(y)[x]];
  }
  const auto most = std::max_element(votes.begin(), votes.end());
  if (*most < 3 || 2 * *most <= met) return kUnknown;
  return static_cast<std::uint8_t>(most - votes.begin());
}

/// Moves the floor plane to go through an object's foot: multipath light shifts depths by a part of
/// them and bends planes, but an object does stand on the floor. Bent pixels join the plane, and
/// planes beside it that are off by about as much are moved too.
void stand_on_plane(const ObjectFoot& foot, ImageView<const float> depth_m,
                    const geometry::Pinhole& view, Image<std::uint8_t>& plane_of,
                    std::vector<WPlane>& planes) {
  const Eigen::Vector3d floor_m = foot.at_m + kOverFootM * foot.up;
  const auto lies_across = [&](const WPlane& plane) {
    return -plane.abc.normalized().dot(foot.up) >= kLeastUpright;
  };
  const auto over = [&](const WPlane& plane) { return plane.abc.dot(floor_m) - 1; };
  WPlane* nearest = nullptr;
  double least = kMostSunk;
  for (WPlane& plane : planes)
    if (lies_across(plane) && std::abs(over(plane)) < least)
      nearest = &plane, least = std::abs(over(plane));
  if (nearest == nullptr) return;
  const auto number = static_cast<std::uint8_t>(nearest - planes.data());
  for (int v = 0; v < plane_of.height(); ++v)
    for (int u = 0; u < plane_of.width(); ++u) {
      if (plane_of.row(v)[u] != kOffPlanes) continue;
      const double there =
          nearest->at((u - view.cx_px) / view.fx_px, (v - view.cy_px) / view.fy_px);
      if (std::abs(there * static_cast<double>(depth_m.row(v)[u]) - 1) < kBentPart)
        plane_of.row(v)[u] = number;
    }
  const double off = over(*nearest);
  for (WPlane& plane : planes)
    if (lies_across(plane) && std::abs(over(plane) - off) < kBentPart)
      plane.abc /= plane.abc.dot(floor_m);
}

PackedNormal normal_of(const WPlane& plane) {
  const Eigen::Vector3d n = -127 * plane.abc.normalized();
  const auto pack = [](double value) { return static_cast<std::int8_t>(std::lround(value)); };
  return {pack(n.x()), pack(n.y()), pack(n.z()), 0};
}

/// Normal at the smallest scale at which it is certain; stops at a scale where it is unknown.
PackedNormal certain_normal(ImageView<const float> depth_m, const geometry::Pinhole& view,
                            const NoiseParams& noise, int u, int v, int footprint_px) {
  const double z = depth_m.row(v)[u];
  PackedNormal best = normal_at(depth_m, view, u, v, 2 * footprint_px);
  for (int scale = 2; scale <= kMostScale; scale *= 2) {
    // Slope of 25 depths in five columns `step` pixels apart.
    const double step = std::max(1, footprint_px) * (scale / 2);
    const double angle = noise.sigma_m(static_cast<float>(z)) * view.fx_px / (7 * step * z);
    if (angle <= kNormalAngle_rad) break;
    const PackedNormal wider = normal_at(depth_m, view, u, v, 2 * scale * footprint_px);
    if (wider.x == 0 && wider.y == 0 && wider.z == 0) break;
    best = wider;
  }
  return best;
}

}  // namespace

LightSurface light_surface(ImageView<const float> depth_m, const geometry::Pinhole& view,
                           const NoiseParams& noise, int footprint_px,
                           std::span<const ObjectFoot> feet) {
  const Cells cells =
      make_cells(depth_m, view, noise, std::clamp(2 * footprint_px, kLeastCell_px, kMostCell_px));
  std::vector<WPlane> planes = find_planes(cells);
  Image<std::uint8_t> plane_of = plane_of_pixels(depth_m, view, noise, cells, planes);
  join_outliers(depth_m, view, noise, cells.side_px, planes, plane_of);
  for (const ObjectFoot& foot : feet) stand_on_plane(foot, depth_m, view, plane_of, planes);
  std::array<PackedNormal, kMostPlanes> normals{};
  std::transform(planes.begin(), planes.end(), normals.begin(), normal_of);
  LightSurface out{Image<float>(depth_m.size), Image<PackedNormal>(depth_m.size),
                   Image<std::uint8_t>(depth_m.size, kNoPlane), planes};
  for (int v = 0; v < plane_of.height(); ++v)
    for (int u = 0; u < plane_of.width(); ++u) {
      std::uint8_t plane = plane_of.row(v)[u];
      if (plane == kUnknown) plane = plane_around(plane_of, u, v);
      if (plane == kUnknown) continue;
      if (plane == kOffPlanes) {
        out.depth_m.row(v)[u] = depth_m.row(v)[u];
        out.normal.row(v)[u] = certain_normal(depth_m, view, noise, u, v, footprint_px);
        continue;
      }
      const double w =
          planes[plane].at((u - view.cx_px) / view.fx_px, (v - view.cy_px) / view.fy_px);
      if (!(w > 1 / kFarthestM) || !(w < 1 / kNearestM)) continue;
      out.depth_m.row(v)[u] = static_cast<float>(1 / w);
      out.normal.row(v)[u] = normals[plane];
      out.plane.row(v)[u] = plane;
    }
  return out;
}

std::vector<ObjectFoot> feet_of(std::span<const VirtualObject> objects,
                                const geometry::Pose& camera_from_world) {
  std::vector<ObjectFoot> feet;
  for (const VirtualObject& object : objects) {
    if (object.in_set) continue;
    glm::vec3 low(std::numeric_limits<float>::max()), high = -low;
    for (const MeshView& mesh : object.meshes)
      for (const glm::vec3& p : mesh.positions_m) low = glm::min(low, p), high = glm::max(high, p);
    if (!(low.x <= high.x)) continue;
    const geometry::Pose camera_from_object = camera_from_world * object.world_from_object;
    const Eigen::Vector3d foot_m(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), low.z);
    feet.push_back({camera_from_object * (object.scale * foot_m),
                    camera_from_object.rotation * Eigen::Vector3d::UnitZ()});
  }
  return feet;
}

}  // namespace mixrig::render
