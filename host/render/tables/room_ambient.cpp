// SPDX-License-Identifier: Apache-2.0
#include "host/render/tables/room_ambient.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "hal/base/learned_color.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {
namespace {

constexpr double kMostAmbientSamples = 40000;  // of a picture
/// The sphere is divided into parts of equal area.
constexpr int kAmbientRings = 12, kAmbientColumns = 24;
constexpr double kLampMarginM = 0.1;  // the frame around a panel
/// Metres: surfaces nearer to the objects' box, such as the floor below it, are covered by the
/// objects.
constexpr double kCoveredM = 0.05;
/// Mean square of each spherical-harmonics polynomial over the sphere.
constexpr std::array<double, kAmbientTermCount> kMeanSquare{
    1, 1. / 3, 1. / 3, 1. / 3, 1. / 15, 1. / 15, 4. / 5, 1. / 15, 4. / 15};

std::array<double, kAmbientTermCount> polynomials(const glm::dvec3& d) {
  return {
      1, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3 * d.z * d.z - 1, d.x * d.z, d.x * d.x - d.y * d.y};
}

/// Box around the objects, in world axes.
struct ObjectsBox {
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{-low};
  glm::dvec3 middle_m() const { return 0.5 * (low + high); }
  bool holds(const glm::dvec3& p) const {
    return glm::all(glm::greaterThan(p, low - kCoveredM)) &&
           glm::all(glm::lessThan(p, high + kCoveredM));
  }
};

ObjectsBox box_of(const std::vector<VirtualObject>& objects) {
  ObjectsBox box;
  for (const VirtualObject& object : objects) {
    if (object.in_set) continue;
    const glm::dmat4 world_from_object = to_glm(object.world_from_object.matrix());
    for (const MeshView& mesh : object.meshes)
      for (const glm::vec3& p : mesh.positions_m) {
        const glm::dvec3 at(world_from_object * glm::dvec4(object.scale * glm::dvec3(p), 1));
        box.low = glm::min(box.low, at), box.high = glm::max(box.high, at);
      }
  }
  return box;
}

/// Light that reaches a point, summed by direction.
class LightFromRoom {
 public:
  LightFromRoom(const CompositorSetup& setup)
      : lamps_(setup.light.lamps), box_(box_of(setup.objects)) {}

  /// Adds a surface that covers `per_m2` steradians at a distance of a metre.
  void add(const glm::dvec3& world_m, const glm::dvec3& linear, double per_m2) {
    if (box_.holds(world_m) || is_lamp(world_m)) return;
    const glm::dvec3 to = world_m - box_.middle_m();
    const double distance2 = glm::dot(to, to);
    const glm::dvec3 d = to / std::sqrt(distance2);
    const double turn = 0.5 + 0.5 * std::atan2(d.y, d.x) / std::numbers::pi;
    const int ring =
        std::clamp(static_cast<int>(0.5 * (d.z + 1) * kAmbientRings), 0, kAmbientRings - 1);
    const int column = std::clamp(static_cast<int>(turn * kAmbientColumns), 0, kAmbientColumns - 1);
    glm::dvec4& part = parts_[static_cast<std::size_t>(ring * kAmbientColumns + column)];
    part += per_m2 / distance2 * glm::dvec4(linear, 1);
  }

  /// `unseen`: light from parts to which nothing was added. Nullopt if nothing was added at all.
  std::optional<AmbientTerms> terms(const glm::dvec3& unseen, double exposure) const {
    std::array<glm::dvec3, kAmbientTermCount> sums{};
    bool any = false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const glm::dvec4& part = parts_[i];
      any |= part.w > 0;
      const glm::dvec3 light = part.w > 0 ? glm::dvec3(part) / (exposure * part.w) : unseen;
      const auto p = polynomials(direction(static_cast<int>(i)));
      for (std::size_t k = 0; k < p.size(); ++k) sums[k] += p[k] * light;
    }
    if (!any) return std::nullopt;
    AmbientTerms terms;
    for (std::size_t k = 0; k < sums.size(); ++k)
      terms[k] = glm::vec3(sums[k] / (kMeanSquare[k] * static_cast<double>(parts_.size())));
    return terms;
  }

 private:
  bool is_lamp(const glm::dvec3& world_m) const {
    return std::any_of(lamps_.begin(), lamps_.end(), [&](const geometry::Lamp& lamp) {
      return glm::distance(world_m, to_glm(lamp.position_m)) <
             0.5 * glm::length(to_glm(lamp.size_m)) + kLampMarginM;
    });
  }
  /// Direction of the middle of a part.
  static glm::dvec3 direction(int part) {
    const double z = (part / kAmbientColumns + 0.5) / kAmbientRings * 2 - 1;
    const double turn =
        ((part % kAmbientColumns + 0.5) / kAmbientColumns * 2 - 1) * std::numbers::pi;
    const double across = std::sqrt(1 - z * z);
    return {across * std::cos(turn), across * std::sin(turn), z};
  }
  const std::vector<geometry::Lamp>& lamps_;
  ObjectsBox box_;
  std::array<glm::dvec4, std::size_t{kAmbientRings} * kAmbientColumns> parts_{};
};

/// `linear_at(x, y)`: linear colour of a depth sample, with a negative red where it is unknown.
template <typename LinearAt>
void add_radiance(ImageView<const float> depth_m, const geometry::Pinhole& camera,
                  const geometry::Pose& world_from_camera, LinearAt&& linear_at,
                  LightFromRoom& light) {
  const int step =
      std::max(1, static_cast<int>(std::lround(
                      std::sqrt(static_cast<double>(depth_m.size.area()) / kMostAmbientSamples))));
  const glm::dmat4 world = to_glm(world_from_camera.matrix());
  for (int y = 0; y < depth_m.size.height; y += step)
    for (int x = 0; x < depth_m.size.width; x += step) {
      const double z = depth_m.row(y)[x];
      if (!(z > kNearestM) || !(z < kFarthestM)) continue;
      const glm::dvec3 linear = linear_at(x, y);
      if (linear.r < 0) continue;
      const Eigen::Vector2d ray = camera.unproject({x, y});
      light.add(glm::dvec3(world * glm::dvec4(z * ray.x(), z * ray.y(), z, 1)), linear,
                z * z / std::sqrt(1 + ray.squaredNorm()));
    }
}

void add_still_background(const CompositorSetup& setup, const geometry::Pose& world_from_camera,
                          LightFromRoom& light) {
  const BackgroundView& room = setup.background;
  if (room.depth_m.empty() || room.color.empty()) return;
  add_radiance(
      room.depth_m, setup.view, world_from_camera,
      [&](int x, int y) {
        const Rgbf& c = room.color.row(y)[x];
        return glm::dvec3(c.r, c.g, c.b);
      },
      light);
}

void add_model(const BackgroundModel& model, LightFromRoom& light) {
  if (model.color.empty()) return;
  const auto& linear = linear_of_srgb_bytes();
  for (std::size_t face = 0; face < model.world_from_face.size(); ++face) {
    const Size size = model.camera.size_px;
    const int top = static_cast<int>(face) * size.height;
    add_radiance(
        {model.depth_m.row(top), size, model.depth_m.stride}, model.camera,
        model.world_from_face[face],
        [&](int x, int y) {
          const Rgbx8& c = model.color.row(model.color_factor * (top + y))[model.color_factor * x];
          if (c.x == kUnknownColorByte) return glm::dvec3(-1);
          return glm::dvec3(linear[c.r], linear[c.g], linear[c.b]);
        },
        light);
  }
}

}  // namespace

std::optional<AmbientTerms> make_ambient(const CompositorSetup& setup,
                                         const geometry::Pose& world_from_camera) {
  const bool any_object = std::any_of(
      setup.objects.begin(), setup.objects.end(),
      [](const VirtualObject& object) { return !object.in_set && !object.meshes.empty(); });
  if (!setup.light.by_direction || !any_object || setup.backdrop || setup.open_walls) return {};
  LightFromRoom light(setup);
  add_still_background(setup, world_from_camera, light);
  for (const BackgroundModel& model : setup.background_models) add_model(model, light);
  // The exposure in the precision of LightParams, which multiplies the terms again.
  return light.terms(glm::dvec3(to_glm(setup.light.ambient)),
                     double{static_cast<float>(setup.light.exposure)});
}

}  // namespace mixrig::render
