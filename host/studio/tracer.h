// SPDX-License-Identifier: Apache-2.0
// Rays against triangles: a thin RAII cover of Embree.
#pragma once

#include <cstdint>
#include <memory>

#include "hal/base/result.h"
#include "host/studio/mesh.h"

namespace mixrig::studio {

/// Shadow rays of one lamp go out sixteen at a time, one bit each.
constexpr int kLampSamples = 16;

struct Hit {
  float t = 0;  ///< in lengths of the ray's direction
  Vec3 normal;  ///< interpolated, turned towards the ray's origin
  Vec3 face;    ///< of the triangle, turned towards the ray's origin
  Vec2 uv;
  Material material;
  std::uint32_t triangle = 0;
};

/// An Embree device; scenes keep it alive.
class TraceDevice {
 public:
  /// Errors: kUnsupported where Embree does not start.
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

  /// Swaps `mesh` in and builds the tree; the old mesh comes back for its memory.
  void set(Mesh& mesh);
  const Mesh& mesh() const { return mesh_; }
  bool empty() const { return mesh_.indices.empty(); }

  /// Nearest hit within (0, t_max); false where there is none.
  bool intersect(const Vec3& origin, const Vec3& direction, float t_max, Hit& hit) const;
  /// True where something lies between two points.
  bool blocked(const Vec3& from, const Vec3& to) const;
  /// Bit i is set where something lies between `from` and targets[i]; only bits of `wanted`.
  std::uint16_t blocked16(const Vec3& from, const Vec3* targets, std::uint16_t wanted) const;

 private:
  TraceDevice device_;
  std::shared_ptr<void> scene_;
  Mesh mesh_;
};

}  // namespace mixrig::studio
