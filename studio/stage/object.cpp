// SPDX-License-Identifier: Apache-2.0
// The virtual object: a statue on a crate.
#include "studio/stage/object.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/base/angles.h"
#include "studio/sensors/noise.h"
#include "studio/stage/paint.h"

namespace mixrig::studio {
namespace {

constexpr float kCrate_m = 0.52F, kCrateHigh_m = 0.50F;
constexpr Size kTexture{256, 256};

/// Boards with a frame and a diagonal slat.
Vec3 crate_color(float u, float v) {
  const float edge = std::min({u, 1 - u, v, 1 - v});
  const bool slat = std::abs(u - v) < 0.07F, frame = edge < 0.11F || slat;
  const float along = frame && (v < 0.11F || v > 0.89F || slat) ? u : v;
  const float cross = along == u ? v : u;
  const float grain = 0.7F + 0.6F * fractal_noise({along * 5, cross * 70}, 3, frame ? 91 : 92);
  const float board = std::abs(v * 5 - std::round(v * 5));
  float tone = frame ? 1.0F : 0.72F;
  if (!frame && board < 0.03F) tone *= 0.3F;
  if (std::abs(edge - 0.11F) < 0.006F ||
      (!slat && std::abs(std::abs(u - v) - 0.07F) < 0.008F && edge > 0.11F))
    tone *= 0.4F;
  return tone * grain * Vec3(0.42F, 0.25F, 0.10F);
}

Vec3 marble_color(float u, float v) {
  const float warp = fractal_noise({u * 8, v * 8}, 4, 17);
  const float vein = std::abs(std::sin(9 * (v + 1.4F * warp) + 4 * kPi_f * u));
  const float dark = std::clamp(1 - vein / 0.12F, 0.0F, 1.0F);
  return (1 - 0.45F * dark) * Vec3(0.66F, 0.68F, 0.66F) * (0.9F + 0.15F * warp);
}

void add_face(ObjectMesh& mesh, const Vec3& corner, const Vec3& a, const Vec3& b) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  const Vec3 normal = a.cross(b).normalized();
  for (const auto& [s, t] : {std::pair{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
    mesh.positions_m.push_back(corner + s * a + t * b);
    mesh.normals.push_back(normal);
    mesh.uv.push_back({s, 1 - t});
  }
  for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + i);
}

ObjectMesh make_crate() {
  ObjectMesh mesh;
  const Vec3 x(kCrate_m, 0, 0), y(0, kCrate_m, 0), z(0, 0, kCrateHigh_m);
  const Vec3 low(-kCrate_m / 2, -kCrate_m / 2, 0);
  add_face(mesh, low, x, z);
  add_face(mesh, low + x, y, z);
  add_face(mesh, low + x + y, -x, z);
  add_face(mesh, low + y, -y, z);
  add_face(mesh, low + z, x, y);
  add_face(mesh, low + y, x, -y);
  mesh.texture = paint(kTexture, crate_color);
  return mesh;
}

/// Catmull-Rom curve between values[i] and values[i + 1].
float spline(const std::array<float, 15>& values, std::size_t i, float t) {
  const float b = values[i], c = values[i + 1];
  const float a = i > 0 ? values[i - 1] : b, d = i + 2 < values.size() ? values[i + 2] : c;
  return b + 0.5F * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

/// A figure of revolution with five twisted ribs, a waist and a head.
Vec3 statue_point(float u, float v) {
  constexpr std::array<float, 15> kRadius{0.001F, 0.17F,  0.175F, 0.15F,  0.105F,
                                          0.085F, 0.10F,  0.145F, 0.165F, 0.13F,
                                          0.07F,  0.062F, 0.105F, 0.09F,  0.001F};
  constexpr std::array<float, 15> kHeight{0.0F,  0.0F,  0.04F,  0.07F,  0.12F, 0.22F, 0.32F, 0.42F,
                                          0.50F, 0.58F, 0.625F, 0.655F, 0.73F, 0.80F, 0.835F};
  const float s = v * 14;
  const auto i = static_cast<std::size_t>(std::clamp(static_cast<int>(s), 0, 13));
  const float t = s - static_cast<float>(i);
  const float r = std::max(0.001F, spline(kRadius, i, t)), h = spline(kHeight, i, t);
  const float ribs = 1 + 0.13F * std::cos(5 * 2 * kPi_f * u + 7 * h) *
                             std::clamp((h - 0.07F) * 12, 0.0F, 1.0F) *
                             std::clamp((0.6F - h) * 12, 0.0F, 1.0F);
  const float angle = 2 * kPi_f * u;
  return {r * ribs * std::cos(angle) + 0.05F * std::sin(5 * h), r * ribs * std::sin(angle),
          kCrateHigh_m + h};
}

ObjectMesh make_statue() {
  constexpr int kAround = 44, kUp = 56;
  ObjectMesh mesh;
  for (int j = 0; j <= kUp; ++j)
    for (int i = 0; i <= kAround; ++i) {
      const float u = static_cast<float>(i) / kAround, v = static_cast<float>(j) / kUp;
      constexpr float kStep = 1e-3F;
      const float v0 = std::clamp(v, 0.004F, 0.996F);
      const Vec3 du = statue_point(u + kStep, v0) - statue_point(u - kStep, v0);
      const Vec3 dv = statue_point(u, v0 + kStep) - statue_point(u, v0 - kStep);
      mesh.positions_m.push_back(statue_point(u, v));
      mesh.normals.push_back(du.cross(dv).normalized());
      mesh.uv.push_back({2 * u, 1 - v});
    }
  constexpr std::uint32_t kRow = kAround + 1;
  for (std::uint32_t j = 0; j < kUp; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t a = j * kRow + i;
      for (const std::uint32_t k : {a, a + 1, a + kRow + 1, a, a + kRow + 1, a + kRow})
        mesh.indices.push_back(k);
    }
  mesh.texture = paint(kTexture, marble_color);
  return mesh;
}

}  // namespace

VirtualObject build_object(const geometry::Pose& world_from_object, bool glossy) {
  VirtualObject object;
  object.name = "statue";
  object.meshes.push_back(make_crate());
  object.meshes.push_back(make_statue());
  if (glossy) {
    constexpr float kRoughness = 0.35F;
    for (ObjectMesh& mesh : object.meshes) mesh.glossy = true, mesh.roughness = kRoughness;
  }
  object.world_from_object = world_from_object;
  return object;
}

Mesh object_in_world(const VirtualObject& object) {
  Mesh world;
  const Eigen::Quaternionf turn = object.world_from_object.rotation.cast<float>();
  const Vec3 move = object.world_from_object.translation_m.cast<float>();
  for (std::size_t m = 0; m < object.meshes.size(); ++m) {
    const ObjectMesh& mesh = object.meshes[m];
    const auto first = static_cast<std::uint32_t>(world.positions.size());
    for (const Vec3& p : mesh.positions_m) world.positions.push_back(turn * p + move);
    for (const Vec3& n : mesh.normals) world.normals.push_back(turn * n);
    world.uv.insert(world.uv.end(), mesh.uv.begin(), mesh.uv.end());
    for (const std::uint32_t i : mesh.indices) world.indices.push_back(first + i);
    world.materials.insert(world.materials.end(), mesh.indices.size() / 3,
                           {Kind::kObject, static_cast<std::uint8_t>(m)});
  }
  return world;
}

}  // namespace mixrig::studio
