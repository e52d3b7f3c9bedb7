// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/room_shade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/render/tables/prepare.h"
#include "host/render/tables/room_mesh.h"

namespace mixrig::render {
namespace {
constexpr int kLampPoints = 16;  // of a panel, each with its own map
constexpr int kRoomMapTexels = 256;
constexpr double kMostTanHalf = 3.0;
constexpr float kLampNearM = 0.2F;  // nearer to a lamp is its own housing
constexpr double kLeastCellM = 0.04, kMostGridPoints = 1e5;
/// A lamp of which every receiver sees at least this share counts as not hidden.
constexpr float kMostSeen = 0.98F;

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{-low};
  bool empty() const { return !(low.x <= high.x); }
  void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
};

/// Bounding sphere of an object's box.
struct ObjectBall {
  glm::dvec3 center_m;
  double radius_m = 0;
};

Box box_of(const VirtualObject& object) {
  Box box;
  const glm::dmat4 world_from_object = to_glm(object.world_from_object.matrix());
  for (const MeshView& mesh : object.meshes)
    for (const glm::vec3& p : mesh.positions_m)
      box.add(glm::dvec3(world_from_object * glm::dvec4(object.scale * glm::dvec3(p), 1)));
  return box;
}

/// Whether the shadow of a sphere can reach a point.
bool may_shade(const geometry::Lamp& lamp, const ObjectBall& ball, const glm::dvec3& p) {
  const glm::dvec3 lamp_m = to_glm(lamp.position_m);
  const glm::dvec3 axis = ball.center_m - lamp_m, to = p - lamp_m;
  const double distance = glm::length(axis), reach = ball.radius_m + disc_radius_m(lamp);
  if (distance <= reach) return true;
  if (glm::length(to) < distance - ball.radius_m) return false;
  const double across = reach / distance;  // sine of the cone's half angle
  return glm::dot(axis, to) >= std::sqrt(1 - across * across) * distance * glm::length(to);
}

/// Places where a lamp's visibility matters: the objects, and the real surfaces that they can
/// shade.
struct Receivers {
  std::vector<Box> objects;
  std::vector<glm::dvec3> room_m;
  Box all;
};

Receivers find_receivers(const CompositorSetup& setup, const RoomMesh& room) {
  Receivers found;
  std::vector<ObjectBall> casters;
  for (const VirtualObject& object : setup.objects) {
    const Box own = box_of(object);
    if (own.empty()) continue;
    found.objects.push_back(own);
    found.all.add(own.low), found.all.add(own.high);
    if (object.casts_shadow)
      casters.push_back({0.5 * (own.low + own.high), 0.5 * glm::distance(own.low, own.high)});
  }
  for (const glm::vec3& point : room.positions_m) {
    const glm::dvec3 p(point);
    const bool shaded = std::any_of(casters.begin(), casters.end(), [&](const ObjectBall& ball) {
      return std::any_of(setup.light.lamps.begin(), setup.light.lamps.end(),
                         [&](const geometry::Lamp& lamp) { return may_shade(lamp, ball, p); });
    });
    if (!shaded) continue;
    found.room_m.push_back(p);
    found.all.add(p);
  }
  return found;
}

/// Depth map of the room from a point of a lamp: the largest inverse depth of each texel.
class LampView {
 public:
  LampView() : w_({kRoomMapTexels, kRoomMapTexels}) {}

  /// Clears the map and aims it from `eye_m` at a box.
  void look(const glm::dvec3& eye_m, const Box& box) {
    const glm::dvec3 z = glm::normalize(0.5 * (box.low + box.high) - eye_m);
    const glm::dvec3 other = std::abs(z.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(other, z)), y = glm::cross(z, x);
    eye_m_ = eye_m;
    axes_ = glm::transpose(glm::dmat3(x, y, z));
    double tan_half = 0;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 p =
          axes_ * (glm::dvec3(i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                              i & 4 ? box.high.z : box.low.z) -
                   eye_m);
      const double tan = std::max(std::abs(p.x), std::abs(p.y)) / p.z;
      tan_half = std::max(tan_half, p.z > kLampNearM ? tan : kMostTanHalf);
    }
    focal_ = static_cast<float>((kCenter - 1) / std::min(tan_half, kMostTanHalf));
    w_.fill(0);
  }
  /// (u, v, w): texel coordinates and inverse depth; all 0 if the point is too near or behind.
  glm::vec3 project(const glm::dvec3& world_m) const {
    const glm::vec3 p(axes_ * (world_m - eye_m_));
    if (!(p.z > kLampNearM)) return glm::vec3(0);
    const float w = 1 / p.z;
    return {focal_ * p.x * w + kCenter, focal_ * p.y * w + kCenter, w};
  }
  void draw(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 ab = b - a, ac = c - a;
    const float area = ab.x * ac.y - ab.y * ac.x;
    if (area == 0) return;
    const auto [x0, x1] = texels(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}));
    const auto [y0, y1] = texels(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const float dx = static_cast<float>(x) - a.x, dy = static_cast<float>(y) - a.y;
        const float s = (dx * ac.y - dy * ac.x) / area, t = (ab.x * dy - ab.y * dx) / area;
        if (s < 0 || t < 0 || s + t > 1) continue;
        w_.row(y)[x] = std::max(w_.row(y)[x], a.z + s * ab.z + t * ac.z);
      }
  }
  /// Whether the room hides the eye from a point, by a surface at least `least_m` before it.
  bool hides(const glm::dvec3& world_m, float least_m) const {
    const glm::vec3 p = project(world_m);
    if (p.z == 0) return false;
    const float u = p.x + 0.5F, v = p.y + 0.5F;
    if (!(u >= 0 && v >= 0 && u < kRoomMapTexels && v < kRoomMapTexels)) return false;
    return w_.row(static_cast<int>(v))[static_cast<int>(u)] * (1 / p.z - least_m) > 1;
  }

 private:
  static constexpr float kCenter = 0.5F * (kRoomMapTexels - 1);
  /// First and last whole texel between two places, within the map.
  static std::pair<int, int> texels(float low, float high) {
    return {static_cast<int>(std::ceil(std::max(low, 0.0F))),
            static_cast<int>(std::floor(std::min(high, 1.0F * (kRoomMapTexels - 1))))};
  }

  glm::dvec3 eye_m_{0};
  glm::dmat3 axes_{1};
  float focal_ = 1;
  Image<float> w_;
};

/// Points spread over a panel; a single one for a point lamp.
std::vector<glm::dvec3> points_of(const geometry::Lamp& lamp, const glm::dvec3& target_m) {
  const glm::dvec3 middle_m = to_glm(lamp.position_m);
  if (!(disc_radius_m(lamp) > 0)) return {middle_m};
  const auto [u_m, v_m] = half_sides_m(lamp, target_m - middle_m);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < kLampPoints; ++i) {
    const glm::dvec2 tap(panel_tap(i, kLampPoints));
    points.push_back(middle_m + tap.x * u_m + tap.y * v_m);
  }
  return points;
}

void draw(const RoomMesh& room, LampView& view, std::vector<glm::vec3>& projected) {
  projected.clear();
  for (const glm::vec3& p : room.positions_m) projected.push_back(view.project(glm::dvec3(p)));
  for (std::size_t i = 0; i < room.indices.size(); i += 3) {
    const glm::vec3 &a = projected[room.indices[i]], &b = projected[room.indices[i + 1]],
                    &c = projected[room.indices[i + 2]];
    if (a.z > 0 && b.z > 0 && c.z > 0) view.draw(a, b, c);
  }
}

RoomShade make_grid(const Box& box) {
  RoomShade grid;
  const glm::dvec3 size = box.high - box.low;
  grid.cell_m = std::max(kLeastCellM, std::cbrt(size.x * size.y * size.z / kMostGridPoints));
  grid.cells = glm::ivec3(glm::ceil(size / grid.cell_m)) + 1;
  grid.first_m = box.low;
  return grid;
}

}  // namespace

bool needs_room_shade(const CompositorSetup& setup) {
  const bool room = !setup.background.depth_m.empty() || !setup.background_models.empty();
  return room && !setup.backdrop && !setup.open_walls && !setup.objects.empty() &&
         !setup.light.lamps.empty();
}

namespace {

/// Visible shares of one lamp at all points of the grid.
class LampGrid {
 public:
  LampGrid(const RoomShade& grid, const RoomMesh& room)
      : grid_(grid),
        room_(room),
        share_(static_cast<std::size_t>(grid.cells.x) * static_cast<std::size_t>(grid.cells.y) *
               static_cast<std::size_t>(grid.cells.z)) {}

  void find(const geometry::Lamp& lamp, const Box& box) {
    const std::vector<glm::dvec3> eyes = points_of(lamp, 0.5 * (box.low + box.high));
    std::fill(share_.begin(), share_.end(), 1.0F);
    for (const glm::dvec3& eye_m : eyes) {
      view_.look(eye_m, box);
      draw(room_, view_, projected_);
      subtract_hidden(1 / static_cast<float>(eyes.size()));
    }
  }
  /// Whether any receiver sees noticeably less than the whole lamp.
  bool matters(const geometry::Lamp& lamp, const Receivers& receivers) const {
    const auto dark = [&](const glm::ivec3& cell) { return share_[index(cell)] < kMostSeen; };
    for (const Box& box : receivers.objects) {
      const glm::ivec3 low = cell_of(box.low), high = cell_of(box.high);
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x)
            if (dark({x, y, z})) return true;
    }
    return std::any_of(receivers.room_m.begin(), receivers.room_m.end(), [&](const auto& p) {
      const glm::dvec3 to_lamp = glm::normalize(to_glm(lamp.position_m) - p);
      return dark(cell_of(p + grid_.cell_m * to_lamp));
    });
  }
  const std::vector<float>& share() const { return share_; }

 private:
  void subtract_hidden(float part) {
    std::size_t i = 0;
    for (int z = 0; z < grid_.cells.z; ++z)
      for (int y = 0; y < grid_.cells.y; ++y)
        for (int x = 0; x < grid_.cells.x; ++x, ++i)
          if (view_.hides(grid_.first_m + grid_.cell_m * glm::dvec3(x, y, z),
                          static_cast<float>(grid_.cell_m)))
            share_[i] -= part;
  }
  glm::ivec3 cell_of(const glm::dvec3& world_m) const {
    const glm::dvec3 at = glm::round((world_m - grid_.first_m) / grid_.cell_m);
    return glm::clamp(glm::ivec3(at), glm::ivec3(0), grid_.cells - 1);
  }
  std::size_t index(const glm::ivec3& cell) const {
    return static_cast<std::size_t>((cell.z * grid_.cells.y + cell.y) * grid_.cells.x + cell.x);
  }

  const RoomShade& grid_;
  const RoomMesh& room_;
  LampView view_;
  std::vector<glm::vec3> projected_;
  std::vector<float> share_;
};

}  // namespace

RoomShade make_room_shade(const CompositorSetup& setup, const geometry::Pose& world_from_camera) {
  const RoomMesh room = make_room_mesh(setup, world_from_camera);
  const Receivers receivers = find_receivers(setup, room);
  if (receivers.all.empty()) return {};
  RoomShade grid = make_grid(receivers.all);
  LampGrid one(grid, room);
  for (const geometry::Lamp& lamp : setup.light.lamps) {
    grid.layer_of.push_back(-1);
    if (lamp.is_dark()) continue;
    one.find(lamp, receivers.all);
    if (!one.matters(lamp, receivers)) continue;
    grid.layer_of.back() = grid.layers++;
    grid.share.insert(grid.share.end(), one.share().begin(), one.share().end());
  }
  return grid;
}

}  // namespace mixrig::render
