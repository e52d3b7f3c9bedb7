// SPDX-License-Identifier: Apache-2.0
// The visible surface of one scene in each pixel.
#include "studio/stage/surfels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixrig::studio {
namespace {

constexpr int kSurfelBand = 16;  ///< rows that share corner rays

struct Probe {
  Surfel surfel;
  Vec3 position, face;
  Material material;
};

Probe probe(const TraceScene& scene, const Materials& materials, const CameraRays& rays, float u,
            float v) {
  Probe result;
  Hit hit;
  const Vec3 direction = rays.direction(u, v);
  if (!scene.intersect(rays.position, direction, kMiss, hit)) return result;
  result.position = rays.position + hit.t * direction;
  result.face = hit.face;
  result.material = hit.material;
  Surfel& s = result.surfel;
  s.z = hit.t;
  s.normal = hit.normal;
  s.origin = result.position + kShadowOffset_m * hit.face;
  s.albedo = materials.albedo(hit.material, hit.uv, result.position);
  s.kind = hit.material.kind;
  s.glows = hit.material.kind == Kind::kLamp;
  s.person = hit.material.person;
  return result;
}

/// True if all four corners lie on one smooth surface.
bool agree(const Probe* const (&corners)[4]) {
  const Probe& first = *corners[0];
  for (const Probe* p : corners) {
    if (p->surfel.z == kMiss || !(p->material == first.material)) return false;
    if (p->surfel.normal.dot(first.surfel.normal) < 0.9F) return false;
    const Vec3 across = p->position - first.position;
    if (std::abs(first.face.dot(across)) > 0.0012F * first.surfel.z) return false;
  }
  return true;
}

Surfel mean(const Probe* const (&corners)[4]) {
  Surfel s = corners[0]->surfel;
  for (int i = 1; i < 4; ++i) {
    const Surfel& other = corners[i]->surfel;
    s.origin += other.origin, s.normal += other.normal, s.albedo += other.albedo, s.z += other.z;
  }
  s.origin *= 0.25F, s.albedo *= 0.25F, s.z *= 0.25F;
  s.normal.normalize();
  // The corners of a curved surface stand over their mean, and shade it unless it is lifted.
  constexpr float kLeastLift_m = 2e-4F;
  float lift_m = 0;
  for (const Probe* p : corners)
    lift_m = std::max(lift_m, s.normal.dot(p->surfel.origin - s.origin));
  if (lift_m > kLeastLift_m) s.origin += lift_m * s.normal;
  return s;
}

/// Sub-sample i of pixel (x, y).
Probe sub_sample(const TraceScene& scene, const Materials& materials, const CameraRays& rays, int x,
                 int y, int i) {
  const float u = static_cast<float>(x) + (static_cast<float>(i % 4) + 0.5F) / 4 - 0.5F;
  const float v = static_cast<float>(y) + (static_cast<float>(i / 4) + 0.5F) / 4 - 0.5F;
  return probe(scene, materials, rays, u, v);
}

/// The object's texture may be finer than a pixel, where its corners do not tell the mean.
Vec3 mean_albedo(const TraceScene& scene, const Materials& materials, const CameraRays& rays, int x,
                 int y) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < kSubSamples; ++i)
    sum += sub_sample(scene, materials, rays, x, y, i).surfel.albedo;
  return sum / kSubSamples;
}

}  // namespace

CameraRays camera_rays(const RayGrid& grid, const geometry::Pose& world_from_camera) {
  return {&grid, world_from_camera.translation_m.cast<float>(),
          world_from_camera.rotation.toRotationMatrix().cast<float>()};
}

void SurfelMap::build(const TraceScene& scene, const Materials& materials, const CameraRays& rays,
                      const Rect& rect, Crew& crew, const std::vector<std::uint8_t>* thin) {
  rect_ = rect;
  if (rect.empty()) return;
  const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
  if (rows_.size() < static_cast<std::size_t>(height))
    rows_.resize(static_cast<std::size_t>(height));
  const auto trace_corners = [&](int y, std::vector<Probe>& corners) {
    corners.resize(static_cast<std::size_t>(width) + 1);
    for (int i = 0; i <= width; ++i)
      corners[static_cast<std::size_t>(i)] =
          probe(scene, materials, rays, static_cast<float>(rect.x0 + i) - 0.5F,
                static_cast<float>(y) - 0.5F);
  };
  const auto trace_pixel = [&](int x, int y, std::vector<Surfel>& surfels) {
    bool any = false;
    const std::size_t first = surfels.size();
    for (int i = 0; i < kSubSamples; ++i) {
      surfels.push_back(sub_sample(scene, materials, rays, x, y, i).surfel);
      any |= surfels.back().z != kMiss;
    }
    if (!any) surfels.resize(first);
    return probe(scene, materials, rays, static_cast<float>(x), static_cast<float>(y)).surfel.z;
  };
  crew.rows(height, kSurfelBand, [&](int begin, int end) {
    std::vector<Probe> above, below;
    std::vector<Surfel> surfels;  // grows here; the stored row is copied without spare capacity
    trace_corners(rect.y0 + begin, below);
    for (int j = begin; j < end; ++j) {
      std::swap(above, below);
      trace_corners(rect.y0 + j + 1, below);
      Row& row = rows_[static_cast<std::size_t>(j)];
      surfels.clear(), row.begin.clear(), row.centre_z.clear();
      for (int i = 0; i < width; ++i) {
        row.begin.push_back(static_cast<std::uint32_t>(surfels.size()));
        const auto at = static_cast<std::size_t>(i);
        const Probe* const corners[4]{&above[at], &above[at + 1], &below[at], &below[at + 1]};
        const auto misses = std::count_if(std::begin(corners), std::end(corners),
                                          [](const Probe* p) { return p->surfel.z == kMiss; });
        float z = kMiss;
        const bool is_thin = thin != nullptr && !thin->empty() &&
                             (*thin)[static_cast<std::size_t>(j) * width + at] != 0;
        if (misses < 4 || is_thin) {
          if (!is_thin && agree(corners)) {
            surfels.push_back(mean(corners));
            if (surfels.back().kind == Kind::kObject)
              surfels.back().albedo = mean_albedo(scene, materials, rays, rect.x0 + i, rect.y0 + j);
            z = surfels.back().z;
          } else {
            z = trace_pixel(rect.x0 + i, rect.y0 + j, surfels);
          }
        }
        row.centre_z.push_back(z);
      }
      row.begin.push_back(static_cast<std::uint32_t>(surfels.size()));
      row.surfels.assign(surfels.begin(), surfels.end());
    }
  });
}

float SurfelMap::centre_z(int x, int y) const {
  if (x < rect_.x0 || x >= rect_.x1 || y < rect_.y0 || y >= rect_.y1) return kMiss;
  return rows_[static_cast<std::size_t>(y - rect_.y0)]
      .centre_z[static_cast<std::size_t>(x - rect_.x0)];
}

std::vector<std::uint8_t> touched_by_thin(const Mesh& mesh, const Optics& optics,
                                          const geometry::Pose& world_from_camera,
                                          const Rect& rect) {
  std::vector<std::uint8_t> marks;
  if (rect.empty()) return marks;
  const geometry::Pose camera_from_world = geometry::inverse(world_from_camera);
  const int width = rect.x1 - rect.x0;
  for (std::size_t t = 0; t < mesh.materials.size(); ++t) {
    if (!is_thin(mesh.materials[t].kind)) continue;
    marks.resize(static_cast<std::size_t>(width) * (rect.y1 - rect.y0));
    Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d p =
          camera_from_world * mesh.positions[mesh.indices[3 * t + k]].cast<double>();
      if (p.z() < 0.1) continue;
      const Eigen::Vector2d px = project(optics, p);
      low = low.cwiseMin(px), high = high.cwiseMax(px);
    }
    for (int y = std::max(rect.y0, static_cast<int>(std::floor(low.y() + 0.5)));
         y <= std::min(rect.y1 - 1, static_cast<int>(std::floor(high.y() + 0.5))); ++y)
      for (int x = std::max(rect.x0, static_cast<int>(std::floor(low.x() + 0.5)));
           x <= std::min(rect.x1 - 1, static_cast<int>(std::floor(high.x() + 0.5))); ++x)
        marks[static_cast<std::size_t>(y - rect.y0) * width + (x - rect.x0)] = 1;
  }
  return marks;
}

Rect covered_by(const Mesh& mesh, const Optics& optics, const geometry::Pose& world_from_camera) {
  if (mesh.positions.empty()) return {};
  const geometry::Pose camera_from_world = geometry::inverse(world_from_camera);
  const Eigen::Matrix3f turn = camera_from_world.rotation.toRotationMatrix().cast<float>();
  const Vec3 move = camera_from_world.translation_m.cast<float>();
  const int width = optics.size_px.width, height = optics.size_px.height;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const Vec3& p : mesh.positions) {
    const Vec3 c = turn * p + move;
    // The distortion model is not monotonic far outside the picture, so a mesh there can project
    // anywhere.
    if (c.z() < 0.1F || std::abs(c.x()) > 1.3F * c.z() || std::abs(c.y()) > 1.3F * c.z())
      return {0, 0, width, height};
    const Eigen::Vector2d px = project(optics, c.cast<double>());
    low = low.cwiseMin(px), high = high.cwiseMax(px);
  }
  constexpr double kMargin = 3;
  const auto inside = [](double v, int limit) {
    return static_cast<int>(std::clamp(v, 0.0, 1.0 * limit));
  };
  return {inside(low.x() - kMargin, width), inside(low.y() - kMargin, height),
          inside(high.x() + kMargin, width), inside(high.y() + kMargin, height)};
}

}  // namespace mixrig::studio
