// SPDX-License-Identifier: Apache-2.0
// True light of the room in all directions, from six pictures of a pinhole camera.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "studio/studio_state.h"

namespace mixrig::studio {
namespace {

constexpr int kFace_px = 768;
constexpr double kHalfFace = 1.02;  ///< tangent of half the field: faces overlap

/// Axes of a camera (x right, y down, z ahead) that looks along one of the eye's axes.
Eigen::Matrix3d face_axes(int face) {
  const double side = face % 2 == 0 ? 1 : -1;
  Eigen::Vector3d ahead = Eigen::Vector3d::Zero();
  ahead[face / 2] = side;
  const Eigen::Vector3d down =
      face / 2 == 2 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d(-Eigen::Vector3d::UnitZ());
  Eigen::Matrix3d axes;
  axes << down.cross(ahead), down, ahead;
  return axes;
}

Optics face_optics() {
  constexpr double kMiddle = 0.5 * (kFace_px - 1);
  Optics optics;
  optics.size_px = {kFace_px, kFace_px};
  optics.fx_px = optics.fy_px = 0.5 * kFace_px / kHalfFace;
  optics.cx_px = optics.cy_px = kMiddle;
  return optics;
}

int face_of(const Eigen::Vector3d& ray) {
  Eigen::Index axis = 0;
  ray.cwiseAbs().maxCoeff(&axis);
  return 2 * static_cast<int>(axis) + (ray[axis] > 0 ? 0 : 1);
}

}  // namespace

void Studio::State::draw_room(const Optics& optics, const geometry::Pose& world_from_camera,
                              Image<Rgbf>& light) {
  const RayGrid grid(optics);
  const CameraRays rays = camera_rays(grid, world_from_camera);
  const Size size = optics.size_px;
  SceneSurfels seen;
  seen.room.build(room, materials, rays, {0, 0, size.width, size.height}, crew);
  light_surfels(seen.room, lamps, casters, false, false, crew);
  reflector.eye = world_from_camera.translation_m.cast<float>();
  BounceCache bounce;
  if (options.realism.bounce) {
    Reflector r = reflector;
    r.ambient = ambient;
    bounce.build(r, room, rays, optics, world_from_camera, false, false, crew);
  }
  reflect_static(seen.room, bounce, false);
  const auto exposure = static_cast<float>(info.light.exposure);
  light.reset(size);
  crew.rows(size.height, 4, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Vec3 c = exposure * compose_pixel(seen, x, y, lamps, ambient, casters, false).real;
        light.at(x, y) = {c[0], c[1], c[2]};
      }
  });
}

void Studio::room_light(const geometry::Pose& world_from_eye, Image<Rgbf>& light) {
  State& s = *state_;
  s.place_person(0, 0);  // nobody
  const Optics optics = face_optics();
  std::array<Image<Rgbf>, 6> faces;
  std::array<Eigen::Matrix3d, 6> axes;
  for (int i = 0; i < 6; ++i) {
    axes[i] = face_axes(i);
    geometry::Pose world_from_face = world_from_eye;
    world_from_face.rotation = world_from_eye.rotation * Eigen::Quaterniond(axes[i]);
    s.draw_room(optics, world_from_face, faces[i]);
  }
  s.has_plate = s.has_view = false;
  const Size size = light.size();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / size.width);
      const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / size.height);
      const Eigen::Vector3d ray(-std::sin(azimuth) * std::cos(elevation),
                                std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
      const int face = face_of(ray);
      const Eigen::Vector3d in_face = axes[face].transpose() * ray;
      const auto pixel = [&](double slope, double middle) {
        return std::clamp(static_cast<int>(std::lround(optics.fx_px * slope + middle)), 0,
                          kFace_px - 1);
      };
      light.at(x, y) = faces[face].at(pixel(in_face.x() / in_face.z(), optics.cx_px),
                                      pixel(in_face.y() / in_face.z(), optics.cy_px));
    }
}

}  // namespace mixrig::studio
