// SPDX-License-Identifier: Apache-2.0
// Meshes by formula.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "extras/people/touch/shape.h"

namespace mixrig::touch {

struct TestMesh {
  std::vector<Eigen::Vector3f> positions_m;
  std::vector<std::uint32_t> indices;
  Triangles triangles() const { return {positions_m, indices}; }
};

/// Adds a box whose faces have their own corners, as renderers need them.
inline void add_box(TestMesh& mesh, const Eigen::AlignedBox3f& box) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool far : {false, true}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
      for (int i = 0; i < 4; ++i) {
        Eigen::Vector3f p;
        p[axis] = far ? box.max()[axis] : box.min()[axis];
        p[(axis + 1) % 3] = i & 1 ? box.max()[(axis + 1) % 3] : box.min()[(axis + 1) % 3];
        p[(axis + 2) % 3] = i & 2 ? box.max()[(axis + 2) % 3] : box.min()[(axis + 2) % 3];
        mesh.positions_m.push_back(p);
      }
      for (const std::uint32_t i : {0U, 1U, 3U, 0U, 3U, 2U}) mesh.indices.push_back(first + i);
    }
}

inline TestMesh ball_mesh(float radius_m, int rings = 24) {
  TestMesh mesh;
  const int around = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int a = 0; a < around; ++a) {
      const float polar =
          std::numbers::pi_v<float> * static_cast<float>(r) / static_cast<float>(rings);
      const float turn =
          2 * std::numbers::pi_v<float> * static_cast<float>(a) / static_cast<float>(around);
      mesh.positions_m.push_back(radius_m * Eigen::Vector3f(std::sin(polar) * std::cos(turn),
                                                            std::sin(polar) * std::sin(turn),
                                                            std::cos(polar)));
    }
  for (int r = 0; r < rings; ++r)
    for (int a = 0; a < around; ++a) {
      const auto at = [&](int ring, int step) {
        return static_cast<std::uint32_t>(ring * around + step % around);
      };
      for (const std::uint32_t i :
           {at(r, a), at(r + 1, a), at(r + 1, a + 1), at(r, a), at(r + 1, a + 1), at(r, a + 1)})
        mesh.indices.push_back(i);
    }
  return mesh;
}

}  // namespace mixrig::touch
