// SPDX-License-Identifier: Apache-2.0
// Lamps of a frame and the fields of view of their shadow maps.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "host/render/tables/prepare_axes.h"

namespace mixrig::render {
namespace {

/// Map texels along each axis for a view pixel: the border of a contact shadow is then as sharp as
/// a pixel.
constexpr int kMapTexelsPerPixel = 2;
constexpr int kSmallestMap = 256, kLargestMap = 1024;
// The maps of a panel's four parts together have as many texels as its largest single map.
constexpr int kLargestPartMap = 512;
/// Lamp axes from world: z points from the lamp towards `target`.
glm::dmat4 lamp_from_world(const glm::dvec3& lamp, const glm::dvec3& target) {
  const glm::dvec3 z = glm::normalize(target - lamp);
  const glm::dvec3 other = std::abs(z.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(other, z));
  const glm::dvec3 y = glm::cross(z, x);
  glm::dmat4 m(1);
  for (int i = 0; i < 3; ++i) m[i] = glm::dvec4(x[i], y[i], z[i], 0);
  m[3] = glm::dvec4(-glm::dot(x, lamp), -glm::dot(y, lamp), -glm::dot(z, lamp), 1);
  return m;
}

/// Corners of an object's box, in world axes.
void append_corners(const VirtualObject& object, std::vector<glm::dvec3>& corners) {
  glm::vec3 low(std::numeric_limits<float>::max()), high = -low;
  for (const MeshView& mesh : object.meshes)
    for (const glm::vec3& p : mesh.positions_m) low = glm::min(low, p), high = glm::max(high, p);
  if (!(low.x <= high.x)) return;
  const glm::dmat4 m = world_from(object);
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        apply(m, {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}));
}

}  // namespace

void include_box(std::span<const glm::dvec3> corners, const glm::dmat4& camera_from_world,
                 const geometry::Pinhole& view, Rect& rect) {
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  int behind = 0;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 p = apply(camera_from_world, corner);
    if (p.z < kNearestM) {
      ++behind;
      continue;
    }
    const Eigen::Vector2d px = view.project({p.x, p.y, p.z});
    x0 = std::min(x0, px.x()), x1 = std::max(x1, px.x());
    y0 = std::min(y0, px.y()), y1 = std::max(y1, px.y());
  }
  if (behind == static_cast<int>(corners.size())) return;
  if (behind > 0) x0 = y0 = -1e9, x1 = y1 = 1e9;
  const auto clip = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const Rect box{
      clip(std::floor(x0), view.size_px.width), clip(std::floor(y0), view.size_px.height),
      clip(std::ceil(x1) + 1, view.size_px.width), clip(std::ceil(y1) + 1, view.size_px.height)};
  if (box.empty()) return;
  if (rect.empty()) rect = box;
  rect = {std::min(rect.x0, box.x0), std::min(rect.y0, box.y0), std::max(rect.x1, box.x1),
          std::max(rect.y1, box.y1)};
}

std::vector<LampPart> whole_lamps(const std::vector<geometry::Lamp>& lamps) {
  std::vector<LampPart> parts;
  for (const geometry::Lamp& lamp : lamps)
    parts.push_back({lamp, static_cast<int>(&lamp - lamps.data()), false});
  return parts;
}

double disc_radius_m(const geometry::Lamp& lamp) {
  return std::sqrt(lamp.size_m.x() * lamp.size_m.y() / M_PI);
}

std::array<glm::dvec3, 2> half_sides_m(const geometry::Lamp& lamp, const glm::dvec3& toward) {
  const auto [u, v] =
      geometry::panel_axes(lamp.direction.value_or(to_eigen(glm::normalize(toward))));
  const glm::dvec2 half_m = lamp.direction
                                ? 0.5 * to_glm(lamp.size_m)
                                : glm::dvec2(0.5 * std::sqrt(M_PI) * disc_radius_m(lamp));
  return {half_m.x * to_glm(u), half_m.y * to_glm(v)};
}

std::vector<LampPart> parts_of_lamps(const std::vector<geometry::Lamp>& lamps) {
  const auto is_panel = [](const geometry::Lamp& lamp) {
    return lamp.direction && disc_radius_m(lamp) > 0;
  };
  const auto panels = static_cast<std::size_t>(std::count_if(lamps.begin(), lamps.end(), is_panel));
  const bool split = lamps.size() + 3 * panels <= std::size_t{kMostLamps};
  std::vector<LampPart> parts;
  for (const geometry::Lamp& lamp : lamps) {
    const int part_of = static_cast<int>(&lamp - lamps.data());
    if (!split || !is_panel(lamp)) {
      parts.push_back({lamp, part_of});
      continue;
    }
    const glm::dvec3 middle_m = to_glm(lamp.position_m);
    const auto [u_m, v_m] = half_sides_m(lamp, to_glm(*lamp.direction));
    for (const auto& [u, v] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}})
      parts.push_back({{to_eigen(middle_m + u * u_m + v * v_m), lamp.direction, 0.5 * lamp.size_m,
                        0.25F * lamp.intensity, lamp.name},
                       part_of,
                       true});
  }
  return parts;
}

/// Updates the objects' boxes, and the fields of the lamps' maps around those that cast shadows.
void FramePreparer::fit_objects() {
  map_size_ = 0;  // forces the maps to be redrawn
  // Forces the maps of people to be fitted again.
  if (!people_fits_.empty()) people_fits_[0].near_m = 0;
  corners_m_.clear(), caster_corners_m_.clear(), fits_.clear();
  for (const VirtualObject& object : setup_.objects) {
    append_corners(object, corners_m_);
    if (object.casts_shadow) append_corners(object, caster_corners_m_);
  }
  for (const LampPart& part : parts_) fits_.push_back(fit_map(part.lamp, caster_corners_m_));
  fit_people_grid();
}

/// Fits a map to what lies between `corners_m` (a multiple of eight); an empty fit for a lamp that
/// cannot light it.
FramePreparer::MapFit FramePreparer::fit_map(const geometry::Lamp& lamp,
                                             std::span<const glm::dvec3> corners_m) const {
  MapFit fit;
  const glm::dvec3 lamp_m = to_glm(lamp.position_m);
  const bool all_behind =
      lamp.direction && std::all_of(corners_m.begin(), corners_m.end(), [&](auto& p) {
        return glm::dot(p - lamp_m, to_glm(*lamp.direction)) <= 0;
      });
  if (corners_m.empty() || lamp.is_dark() || all_behind) return fit;
  glm::dvec3 low = corners_m[0], high = low;
  for (const glm::dvec3& p : corners_m) low = glm::min(low, p), high = glm::max(high, p);
  const glm::dvec3 center = 0.5 * (low + high);
  // A lamp at the centre has no direction towards it: its own is used, or straight down.
  const bool at_center = glm::distance(center, lamp_m) < kNearestM;
  const glm::dvec3 fallback = lamp.direction ? to_glm(*lamp.direction) : glm::dvec3(0, 0, -1);
  fit.lamp_from_world = lamp_from_world(lamp_m, at_center ? lamp_m + fallback : center);
  fit.near_m = 1e9;
  for (const glm::dvec3& corner : corners_m) {
    const glm::dvec3 p = apply(fit.lamp_from_world, corner);
    const double tan =
        p.z > kNearestM ? std::max(std::abs(p.x), std::abs(p.y)) / p.z : kLargestTanHalf;
    fit.tan_half = std::min(kLargestTanHalf, std::max(fit.tan_half, tan));
    fit.near_m = std::max(kNearestM, std::min(fit.near_m, p.z));
  }
  return fit;
}

/// Texels across a map: twice the view pixels across the casters, as a power of two, so that a
/// moving camera seldom changes it.
int FramePreparer::map_size(const glm::dmat4& camera_from_world) const {
  Rect rect;
  include_box(caster_corners_m_, camera_from_world, setup_.view, rect);
  const int wanted = kMapTexelsPerPixel * std::max(rect.x1 - rect.x0, rect.y1 - rect.y0);
  int size = kSmallestMap;
  while (size < wanted && size < kLargestMap) size *= 2;
  return size;
}

LampParams FramePreparer::lamp_params(const geometry::Lamp& lamp, const MapFit& fit,
                                      int map_size_texel, const glm::dmat4& world_from_camera,
                                      const glm::dmat4& camera_from_world) {
  LampParams out;
  out.position_m = apply(camera_from_world, to_glm(lamp.position_m));
  out.direction = lamp.direction
                      ? glm::vec3(glm::dmat3(camera_from_world) * to_glm(*lamp.direction))
                      : glm::vec3(0);
  out.radius_m = static_cast<float>(disc_radius_m(lamp));
  out.intensity = to_glm(lamp.intensity);
  out.map_size_texel = fit.tan_half > 0 ? map_size_texel : 0;
  if (out.map_size_texel == 0) return out;
  out.lamp_from_camera = glm::mat4(fit.lamp_from_world * world_from_camera);
  out.map_center_texel = 0.5F * static_cast<float>(map_size_texel - 1);
  if (out.radius_m > 0) {
    const glm::dmat3 turn(fit.lamp_from_world);
    const auto [u_m, v_m] = half_sides_m(lamp, glm::transpose(turn)[2]);
    out.panel_u = turn * u_m / disc_radius_m(lamp), out.panel_v = turn * v_m / disc_radius_m(lamp);
  }
  // One texel of margin keeps points outside the map lit.
  out.map_focal_texel = (out.map_center_texel - 1) / static_cast<float>(fit.tan_half);
  out.casters_near_m = static_cast<float>(fit.near_m);
  return out;
}

void FramePreparer::update_lamps(const glm::dmat4& world_from_camera,
                                 const glm::dmat4& camera_from_world) {
  const int wanted = caster_corners_m_.empty() ? 0 : map_size(camera_from_world);
  params_.maps_changed = wanted != map_size_;
  map_size_ = wanted;
  for (std::size_t i = 0; i < params_.lamps.size(); ++i) {
    const MapFit& fit = fits_[i];
    const int room_layer = params_.lamps[i].room_layer;
    const int size = parts_[i].is_part ? std::min(map_size_, kLargestPartMap) : map_size_;
    params_.lamps[i] = lamp_params(parts_[i].lamp, fit, size, world_from_camera, camera_from_world);
    params_.lamps[i].room_layer = room_layer;
    params_.lamps[i].part_of = parts_[i].part_of, params_.lamps[i].is_part = parts_[i].is_part;
    if (params_.lamps[i].map_size_texel == 0) continue;
    for (std::size_t k = 0; k < setup_.objects.size(); ++k)
      params_.lamp_from_object[i][k] =
          glm::mat4(fit.lamp_from_world * world_from(setup_.objects[k]));
  }
  update_people(world_from_camera, camera_from_world);
}

}  // namespace mixrig::render
