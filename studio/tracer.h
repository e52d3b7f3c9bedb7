// SPDX-License-Identifier: Apache-2.0
// Rays against triangles: RAII wrappers of Embree.
#pragma once

#include <cstdint>
#include <memory>

#include "hal/base/result.h"
#include "studio/stage/mesh.h"

namespace mixrig::studio {

/// Shadow rays of one lamp: traced as one packet, one bit of the result each.
constexpr int kLampSamples = 16;

struct Hit {
  float t = 0;  ///< multiple of the direction's length
  Vec3 normal;  ///< interpolated shading normal, on the side of the ray's origin
  Vec3 face;    ///< normal of the triangle, on the side of the ray's origin
  Vec2 uv;
  Material material;
  std::uint32_t triangle = 0;
};

/// An Embree device, shared by the scenes that use it.
class TraceDevice {
 public:
  /// Errors: kUnsupported if Embree does not start.
  static Result<TraceDevice> create();
  void* handle() const { return handle_.get(); }

 private:
  std::shared_ptr<void> handle_;
};

/// Triangles to trace. Queries are thread-safe; set() is not.
class TraceScene {
 public:
  explicit TraceScene(const TraceDevice& device);
  TraceScene(TraceScene&&) noexcept;
  TraceScene& operator=(TraceScene&&) noexcept;
  ~TraceScene();

  /// Takes `mesh` and builds the acceleration structure; `mesh` gets the old mesh's memory.
  void set(Mesh& mesh);
  const Mesh& mesh() const { return mesh_; }
  bool empty() const { return mesh_.indices.empty(); }

  /// Nearest hit within (0, t_max); false if there is none.
  bool intersect(const Vec3& origin, const Vec3& direction, float t_max, Hit& hit) const;
  /// True if a triangle lies between two points.
  bool blocked(const Vec3& from, const Vec3& to) const;
  /// Bit i is set if a triangle lies between `from` and targets[i]; only bits of `wanted` are
  /// tested.
  std::uint16_t blocked16(const Vec3& from, const Vec3* targets, std::uint16_t wanted) const;

 private:
  TraceDevice device_;
  std::shared_ptr<void> scene_;
  Mesh mesh_;
};

}  // namespace mixrig::studio
