// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/shape/room_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/base/learned_color.h"
#include "host/room/scan/panorama/around.h"
#include "host/room/scan/panorama/panorama_color.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kFaceGrain = 16;
constexpr double kMargin_px = 2.5;  ///< of depth, past the border of the cube's face

/// Faces ahead, left, back, right, up and down; columns of the rotation are the face's axes.
std::vector<geometry::Pose> cube() {
  const auto face = [](const Vector3d& ahead, const Vector3d& down) {
    Eigen::Matrix3d axes;
    axes << down.cross(ahead), down, ahead;
    return geometry::Pose{Eigen::Quaterniond(axes), Vector3d::Zero()};
  };
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  return {face(y, -z), face(-x, -z), face(-y, -z), face(x, -z), face(z, y), face(-z, -y)};
}

/// Position of a direction in a panorama of that size; the inverse of direction_of().
Vector2d place_of(Size size, const Vector3d& ray) {
  const double azimuth = std::atan2(-ray.x(), ray.y());
  const double elevation = std::atan2(ray.z(), std::hypot(ray.x(), ray.y()));
  return {(std::numbers::pi - azimuth) / (2 * std::numbers::pi) * size.width - 0.5,
          (0.5 - elevation / std::numbers::pi) * size.height - 0.5};
}

bool is_known(const Rgb8& c) { return c.r != 0 || c.g != 0 || c.b != 0; }

/// Red is negative where nothing is known, or where unknown pixels are around.
Rgbf color_of(const Around& around, const Image<Rgb8>& image) {
  const auto c = around.of(image);
  if (!std::all_of(c.begin(), c.end(), is_known)) return {-1, -1, -1};
  const auto& linear = linear_of_srgb_bytes();
  const auto mix = [&](std::uint8_t Rgb8::*channel) {
    return around.mix(linear[c[0].*channel], linear[c[1].*channel], linear[c[2].*channel],
                      linear[c[3].*channel]);
  };
  return {mix(&Rgb8::r), mix(&Rgb8::g), mix(&Rgb8::b)};
}

/// Standard deviation of a channel (mean over channels) under a shift of up to half a pixel along
/// the steeper axis: that of a uniform distribution.
float spread_of(const Around& around, const Image<Rgb8>& image) {
  const auto c = around.of(image);
  const auto& linear = linear_of_srgb_bytes();
  const auto step = [&](const Rgb8& a, const Rgb8& b) {
    return std::abs(linear[a.r] - linear[b.r]) + std::abs(linear[a.g] - linear[b.g]) +
           std::abs(linear[a.b] - linear[b.b]);
  };
  const float across = std::max(step(c[0], c[1]), step(c[2], c[3]));
  const float down = std::max(step(c[0], c[2]), step(c[1], c[3]));
  constexpr float kUniform = 0.2887F;  // 1 / sqrt(12)
  return kUniform * std::max(across, down) / 3;
}

/// Direction of a pixel of a face in base axes, not of unit length: 1 along the face's own axis.
Vector3d toward(const geometry::Pinhole& camera, const geometry::Pose& pose, double x, double y) {
  const Vector2d at = camera.unproject({x, y});
  return pose.rotation * Vector3d(at.x(), at.y(), 1);
}

/// Rows [begin, end) of depth and its spread of a face, which starts at row `top` of the images.
void draw_depth(const Panorama& p, const geometry::Pose& pose, int top, int begin, int end,
                RoomFaces& out) {
  for (int y = begin; y < end; ++y)
    for (int x = 0; x < out.camera.size_px.width; ++x) {
      const Vector3d ray = toward(out.camera, pose, x, y);
      const Vector2d place = place_of(p.size(), ray);
      const auto z = static_cast<float>(1 / ray.norm());
      out.depth_m.row(top + y)[x] = z * distance_between(p, place.x(), place.y());
      const Around around(p.size(), place);
      out.depth_sigma_m.row(top + y)[x] = z * around.of(p.sigma_m)[around.nearest()];
    }
}

/// Rows [begin, end) of its colour, which starts at row `top`.
void draw_face_color(const Panorama& p, const geometry::Pose& pose, int top, int begin, int end,
                     RoomFaces& out) {
  const double factor = out.color_factor;
  for (int y = begin; y < end; ++y)
    for (int x = 0; x < out.color.width(); ++x) {
      const Vector3d ray =
          toward(out.camera, pose, (x + 0.5) / factor - 0.5, (y + 0.5) / factor - 0.5);
      const Around around(p.color.size(), place_of(p.color.size(), ray));
      out.color.row(top + y)[x] =
          learned_color(color_of(around, p.color), spread_of(around, p.color));
    }
}

/// Whether the panorama knows anything that a face sees, by every fourth pixel.
bool sees_anything(const Panorama& p, const geometry::Pinhole& camera, const geometry::Pose& pose) {
  for (int y = 0; y < camera.size_px.height; y += 4)
    for (int x = 0; x < camera.size_px.width; x += 4) {
      const Around around(p.size(), place_of(p.size(), toward(camera, pose, x, y)));
      if (p.distance_m.row(around.y0)[around.x0] > 0) return true;
    }
  return false;
}

/// The pixel of the face whose axis is nearest to a direction, as a row over all faces; row -1
/// where no face has it.
struct FacePlace {
  int x = 0, row = -1;
  float distance_of_z = 1;
};
FacePlace face_place(const RoomFaces& faces, const Vector3d& ray, int factor) {
  FacePlace place;
  double most_z = 0;
  for (std::size_t i = 0; i < faces.base_from_face.size(); ++i) {
    const Vector3d p = faces.base_from_face[i].rotation.conjugate() * ray;
    if (!(p.z() > most_z)) continue;
    most_z = p.z();
    const int side = factor * faces.camera.size_px.width;
    const Vector2d px = ((faces.camera.project(p).array() + 0.5) * factor - 0.5).round();
    const bool inside = (px.array() >= 0).all() && (px.array() < side).all();
    place = {static_cast<int>(px.x()),
             inside ? static_cast<int>(i) * side + static_cast<int>(px.y()) : -1,
             static_cast<float>(1 / p.z())};
  }
  return place;
}

void take_changed_color(const RoomFaces& before, const RoomFaces& after, Panorama& p) {
  const int factor = after.color_factor;
  const Directions ray(p.color.size());
  for (int y = 0; y < p.color.height(); ++y)
    for (int x = 0; x < p.color.width(); ++x) {
      const FacePlace at = face_place(after, ray(x, y), factor);
      if (at.row < 0) continue;
      const Rgbx8 a = before.color.row(at.row)[at.x], b = after.color.row(at.row)[at.x];
      if (a.r == b.r && a.g == b.g && a.b == b.b && a.x == b.x) continue;
      p.color.row(y)[x] = b.x == kUnknownColorByte ? Rgb8{} : Rgb8{b.r, b.g, b.b};
    }
}

}  // namespace

void take_changes(const RoomFaces& before, const RoomFaces& after, Panorama& p) {
  const Directions ray(p.size());
  for (int y = 0; y < p.size().height; ++y)
    for (int x = 0; x < p.size().width; ++x) {
      const FacePlace at = face_place(after, ray(x, y), 1);
      if (at.row < 0) continue;
      const float z_m = after.depth_m.row(at.row)[at.x];
      if (z_m == before.depth_m.row(at.row)[at.x]) continue;
      p.distance_m.row(y)[x] = at.distance_of_z * z_m;
      p.sigma_m.row(y)[x] = at.distance_of_z * after.depth_sigma_m.row(at.row)[at.x];
      p.views.row(y)[x] = z_m > 0 ? 1 : 0;
    }
  take_changed_color(before, after, p);
}

RoomFaces make_faces(const Panorama& panorama, Crew& crew) {
  RoomFaces faces;
  const double focal_px = panorama.size().height / std::numbers::pi;
  const int side = 2 * static_cast<int>(std::ceil(focal_px + kMargin_px)) + 1;
  faces.camera = {{side, side}, focal_px, focal_px, 0.5 * (side - 1), 0.5 * (side - 1)};
  for (const geometry::Pose& pose : cube())
    if (sees_anything(panorama, faces.camera, pose)) faces.base_from_face.push_back(pose);
  const Size size{side, side * static_cast<int>(faces.base_from_face.size())};
  faces.color_factor = panorama.color.height() / panorama.size().height;
  faces.depth_m.reset(size);
  faces.depth_sigma_m.reset(size);
  faces.color.reset({faces.color_factor * size.width, faces.color_factor * size.height});
  for (std::size_t i = 0; i < faces.base_from_face.size(); ++i) {
    const geometry::Pose& pose = faces.base_from_face[i];
    const int top = static_cast<int>(i) * side;
    crew.rows(side, kFaceGrain, [&](int begin, int end) {
      draw_depth(panorama, pose, top, begin, end, faces);
      draw_face_color(panorama, pose, faces.color_factor * top, faces.color_factor * begin,
                      faces.color_factor * end, faces);
    });
  }
  return faces;
}

}  // namespace mixrig::model
