// SPDX-License-Identifier: Apache-2.0
// The visible surface of one scene in each pixel: one surface element (surfel), or sixteen if an
// edge crosses the pixel.
#pragma once

#include <span>

#include "hal/base/parallel.h"
#include "studio/sensors/lens.h"
#include "studio/stage/light.h"
#include "studio/stage/materials.h"

namespace mixrig::studio {

constexpr int kSubSamples = 16;  ///< of an edge pixel, 4 x 4
constexpr float kMiss = 1e9F;    ///< z of a ray that hits nothing
/// Distance of a shadow ray's start from the surface: large enough that the facets of a curved
/// surface do not shade themselves.
constexpr float kShadowOffset_m = 1.5e-3F;

/// The rays of a camera's pixels in the world.
struct CameraRays {
  const RayGrid* grid = nullptr;
  Vec3 position;
  Eigen::Matrix3f world_from_camera;

  /// Direction in world axes, scaled so that the ray parameter is the z depth.
  Vec3 direction(float u_px, float v_px) const {
    const Vec2 p = grid->at(u_px, v_px);
    return world_from_camera * Vec3(p.x(), p.y(), 1);
  }
};
CameraRays camera_rays(const RayGrid& rays, const geometry::Pose& world_from_camera);

struct Surfel {
  Vec3 origin;  ///< start of shadow rays, slightly above the surface
  Vec3 normal;
  Vec3 albedo;
  float z = kMiss;
  Kind kind = Kind::kPaint;
  bool glows = false;       ///< a lamp's face: albedo is its emitted light
  std::uint8_t person = 0;  ///< Material::person
  float real = 0;      ///< lamp light without the virtual object (LampSet::irradiance)
  float mixed = 0;     ///< the same with it
  LampMask open_real = 0, open_mixed = 0;
  Vec3 bounce_real = Vec3::Zero(), bounce_mixed = Vec3::Zero();  ///< light by way of others
  /// Mirrored radiance, people apart, already times `reflectance`.
  Vec3 gloss_real = Vec3::Zero(), gloss_mixed = Vec3::Zero();
  float reflectance = 0;
};

/// Columns and rows [x0, x1) x [y0, y1).
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// Surfels of all pixels of a rectangle; pixels outside have none.
class SurfelMap {
 public:
  /// Traces the corner rays of every pixel, and 16 rays if the corners hit different surfaces.
  /// With `thin`, also in the pixels that it marks, row by row of the rectangle.
  void build(const TraceScene& scene, const Materials& materials, const CameraRays& rays,
             const Rect& rect, Crew& crew, const std::vector<std::uint8_t>* thin = nullptr);

  /// 0, 1 or 16 surfels. Sub-sample i of an edge pixel is at ((i % 4) + 0.5) / 4 - 0.5 across.
  std::span<Surfel> at(int x, int y) { return find(*this, x, y); }
  std::span<const Surfel> at(int x, int y) const { return find(*this, x, y); }
  /// z at the pixel's centre, kMiss if nothing is hit.
  float centre_z(int x, int y) const;
  const Rect& rect() const { return rect_; }
  std::span<Surfel> row(int y) { return rows_[static_cast<std::size_t>(y - rect_.y0)].surfels; }

 private:
  struct Row {
    std::vector<Surfel> surfels;
    std::vector<std::uint32_t> begin;
    std::vector<float> centre_z;
  };
  template <typename Self>
  static auto find(Self& self, int x, int y)
      -> std::span<std::conditional_t<std::is_const_v<Self>, const Surfel, Surfel>> {
    const Rect& r = self.rect_;
    if (x < r.x0 || x >= r.x1 || y < r.y0 || y >= r.y1) return {};
    auto& row = self.rows_[static_cast<std::size_t>(y - r.y0)];
    const std::uint32_t* begin = &row.begin[static_cast<std::size_t>(x - r.x0)];
    return {row.surfels.data() + begin[0], row.surfels.data() + begin[1]};
  }

  Rect rect_;
  std::vector<Row> rows_;
};

/// Marks the pixels of a rectangle that thin parts of a mesh touch; empty if it has none.
std::vector<std::uint8_t> touched_by_thin(const Mesh& mesh, const Optics& optics,
                                          const geometry::Pose& world_from_camera,
                                          const Rect& rect);

/// Pixels that a mesh can cover, with a margin; all pixels if it reaches behind the camera.
Rect covered_by(const Mesh& mesh, const Optics& optics, const geometry::Pose& world_from_camera);

}  // namespace mixrig::studio
