// SPDX-License-Identifier: Apache-2.0
// The basic shapes of room and person.
#include "studio/stage/mesh.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "hal/base/angles.h"

namespace mixrig::studio {
namespace {

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                  Material material) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c});
  mesh.materials.push_back(material);
}

std::uint32_t add_vertex(Mesh& mesh, const Vec3& position, const Vec3& normal, const Vec2& uv) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uv.push_back(uv);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

/// Normals of vertices from `first` on: the sum of their triangles' area vectors.
void smooth_normals(Mesh& mesh, std::size_t first, std::size_t first_index) {
  for (std::size_t i = first; i < mesh.normals.size(); ++i) mesh.normals[i].setZero();
  for (std::size_t i = first_index; i < mesh.indices.size(); i += 3) {
    const auto* t = &mesh.indices[i];
    const Vec3& a = mesh.positions[t[0]];
    const Vec3 area = (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a);
    for (int k = 0; k < 3; ++k) mesh.normals[t[k]] += area;
  }
  for (std::size_t i = first; i < mesh.normals.size(); ++i) mesh.normals[i].normalize();
}

/// Two unit vectors that form a right-handed frame with the unit vector `axis`.
std::array<Vec3, 2> across(const Vec3& axis) {
  const Vec3 other = std::abs(axis.z()) < 0.9F ? Vec3::UnitZ() : Vec3::UnitX();
  const Vec3 x = other.cross(axis).normalized();
  return {x, axis.cross(x)};
}

}  // namespace

void Mesh::clear() {
  positions.clear();
  normals.clear();
  uv.clear();
  indices.clear();
  materials.clear();
}

void add_quad(Mesh& mesh, const Vec3& corner, const Vec3& a, const Vec3& b, Material material) {
  const Vec3 normal = a.cross(b).normalized();
  const float la = a.norm(), lb = b.norm();
  const auto v = add_vertex(mesh, corner, normal, {0, 0});
  add_vertex(mesh, corner + a, normal, {la, 0});
  add_vertex(mesh, corner + a + b, normal, {la, lb});
  add_vertex(mesh, corner + b, normal, {0, lb});
  add_triangle(mesh, v, v + 1, v + 2, material);
  add_triangle(mesh, v, v + 2, v + 3, material);
}

void add_flat(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, Material material) {
  const Vec3 normal = (b - a).cross(c - a).normalized();
  const auto v = add_vertex(mesh, a, normal, {0, 0});
  add_vertex(mesh, b, normal, {1, 0});
  add_vertex(mesh, c, normal, {0.5F, 1});
  add_triangle(mesh, v, v + 1, v + 2, material);
}

void add_box(Mesh& mesh, const Vec3& centre, const Vec3& size, float yaw_rad, Material material) {
  const float c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  const Vec3 x = size.x() * Vec3(c, s, 0), y = size.y() * Vec3(-s, c, 0),
             z = size.z() * Vec3::UnitZ();
  const Vec3 low = centre - 0.5F * (x + y), high = low + x + y + z;
  add_quad(mesh, low, x, z, material);
  add_quad(mesh, low + x, y, z, material);
  add_quad(mesh, low + x + y, -x, z, material);
  add_quad(mesh, low + y, -y, z, material);
  add_quad(mesh, low + y, x, -y, material);
  add_quad(mesh, high, -x, -y, material);
}

void add_loft(Mesh& mesh, std::span<const Ring> rings, int segments, Material material) {
  const std::size_t first = mesh.positions.size(), first_index = mesh.indices.size();
  for (const Ring& ring : rings)
    for (int i = 0; i <= segments; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(segments);
      const float angle = 2 * kPi_f * u;
      add_vertex(mesh, ring.centre + std::cos(angle) * ring.half_x + std::sin(angle) * ring.half_y,
                 Vec3::UnitZ(), {u, ring.v});
    }
  const auto step = static_cast<std::uint32_t>(segments + 1);
  for (std::size_t r = 0; r + 1 < rings.size(); ++r)
    for (int i = 0; i < segments; ++i) {
      const auto a = static_cast<std::uint32_t>(first + r * step + i);
      add_triangle(mesh, a, a + 1, a + step + 1, material);
      add_triangle(mesh, a, a + step + 1, a + step, material);
    }
  for (const bool end : {false, true}) {
    const auto ring = static_cast<std::uint32_t>(first + (end ? (rings.size() - 1) * step : 0));
    const auto tip = add_vertex(mesh, (end ? rings.back() : rings.front()).centre, Vec3::UnitZ(),
                                {0.5F, mesh.uv[ring].y()});
    for (std::uint32_t i = 0; i + 1 < step; ++i)
      add_triangle(mesh, tip, ring + i + (end ? 0 : 1), ring + i + (end ? 1 : 0), material);
  }
  smooth_normals(mesh, first, first_index);
  // The first and last columns of vertices coincide.
  for (std::size_t r = 0; r < rings.size(); ++r) {
    Vec3 &a = mesh.normals[first + r * step], &b = mesh.normals[first + r * step + segments];
    a = b = (a + b).normalized();
  }
}

void add_limb(Mesh& mesh, const Vec3& a, const Vec3& b, float radius_a, float radius_b,
              int segments, Material material) {
  const float length = (b - a).norm();
  const Vec3 axis = (b - a) / std::max(length, 1e-6F);
  const auto [x, y] = across(axis);
  std::vector<Ring> rings;
  constexpr int kCap = 4;
  for (int i = 0; i <= kCap; ++i) {
    const float angle = kPi_f / 2 * (0.06F + 0.94F * static_cast<float>(i) / kCap);
    const float r = radius_a * std::sin(angle), along = -radius_a * std::cos(angle);
    rings.push_back({a + along * axis, r * x, r * y, along});
  }
  for (int i = kCap; i >= 0; --i) {
    const float angle = kPi_f / 2 * (0.06F + 0.94F * static_cast<float>(i) / kCap);
    const float r = radius_b * std::sin(angle), along = radius_b * std::cos(angle);
    rings.push_back({b + along * axis, r * x, r * y, length + along});
  }
  add_loft(mesh, rings, segments, material);
}

void add_cylinder(Mesh& mesh, const Vec3& foot, float radius, float height, int segments,
                  Material material) {
  const Vec3 x = radius * Vec3::UnitX(), y = radius * Vec3::UnitY();
  // Additional rings near the ends keep the edges sharp.
  const float bevel = 0.02F * radius;
  const Vec3 up = Vec3::UnitZ();
  const std::array rings{Ring{foot, 0.98F * x, 0.98F * y, 0},
                         Ring{foot + bevel * up, x, y, bevel},
                         Ring{foot + 0.1F * height * up, x, y, 0.1F * height},
                         Ring{foot + 0.9F * height * up, x, y, 0.9F * height},
                         Ring{foot + (height - bevel) * up, x, y, height - bevel},
                         Ring{foot + height * up, 0.98F * x, 0.98F * y, height}};
  add_loft(mesh, rings, segments, material);
}

void add_ellipsoid(Mesh& mesh, const Vec3& centre, const Vec3& half_x, const Vec3& half_y,
                   const Vec3& half_z, int segments, Material material) {
  std::vector<Ring> rings;
  const int count = std::max(4, segments / 2);
  for (int i = 0; i <= count; ++i) {
    const float v = static_cast<float>(i) / static_cast<float>(count);
    const float angle = kPi_f * std::clamp(v, 0.01F, 0.99F);
    rings.push_back(
        {centre - std::cos(angle) * half_z, std::sin(angle) * half_x, std::sin(angle) * half_y, v});
  }
  add_loft(mesh, rings, segments, material);
}

}  // namespace mixrig::studio
