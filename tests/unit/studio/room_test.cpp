// SPDX-License-Identifier: Apache-2.0
// The room's dimensions, measured by rays.
#include "studio/stage/room.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "studio/stage/object.h"
#include "studio/tracer.h"

namespace mixrig::studio {
namespace {

class Room : public ::testing::Test {
 protected:
  void SetUp() override {
    auto device = TraceDevice::create();
    ASSERT_TRUE(device) << device.error().context;
    scene_.emplace(*device);
    Mesh mesh = build_room({});
    scene_->set(mesh);
  }
  float distance(const Vec3& from, const Vec3& way) const {
    Hit hit;
    return scene_->intersect(from, way, 100, hit) ? hit.t : -1;
  }
  std::optional<TraceScene> scene_;
};

// Schiller et al. 2010, table 1: width 5263, depth 4328, height 2987 mm.
TEST_F(Room, has_the_dimensions_of_schiller_et_al) {
  const Vec3 high(2.0F, 2.1F, 2.6F), free_floor(0.8F, 2.1F, 1.0F);
  EXPECT_NEAR(distance(high, Vec3::UnitX()) + distance(high, -Vec3::UnitX()), 5.263, 1e-4);
  EXPECT_NEAR(distance(high, Vec3::UnitY()) + distance(high, -Vec3::UnitY()), 4.328, 1e-4);
  EXPECT_NEAR(distance(free_floor, Vec3::UnitZ()) + distance(free_floor, -Vec3::UnitZ()), 2.987,
              1e-4);
}

TEST_F(Room, lets_no_ray_out) {
  for (int i = 0; i < 2000; ++i) {
    const float a = 0.37F * static_cast<float>(i), z = -0.999F + 0.001F * static_cast<float>(i);
    const float r = std::sqrt(std::max(0.0F, 1 - z * z));
    const float d = distance({1.9F, 1.9F, 1.2F}, {r * std::cos(a), r * std::sin(a), z});
    EXPECT_GT(d, 0) << i;
    EXPECT_LT(d, 7.0F) << i;
  }
}

TEST_F(Room, has_a_pole_of_24_mm) {
  // The floor lamp stands at (4.75, 1.85).
  EXPECT_NEAR(distance({4.0F, 1.85F, 0.5F}, Vec3::UnitX()), 0.75F - 0.012F, 1e-3);
  EXPECT_GT(distance({4.0F, 1.85F + 0.0125F, 0.5F}, Vec3::UnitX()), 1.0F);
}

TEST(VirtualObject, is_closed_and_turned_outwards) {
  const VirtualObject object = build_object({});
  double volume = 0;
  for (const ObjectMesh& mesh : object.meshes) {
    ASSERT_EQ(mesh.positions_m.size(), mesh.normals.size());
    ASSERT_EQ(mesh.positions_m.size(), mesh.uv.size());
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const Vec3 &a = mesh.positions_m[mesh.indices[i]], &b = mesh.positions_m[mesh.indices[i + 1]],
                 &c = mesh.positions_m[mesh.indices[i + 2]];
      volume += a.dot(b.cross(c)) / 6;  // divergence theorem
    }
  }
  EXPECT_GT(volume, 0.52 * 0.52 * 0.50);
  EXPECT_LT(volume, 0.52 * 0.52 * 0.50 + 0.1);
  EXPECT_LT(object.meshes[0].indices.size() + object.meshes[1].indices.size(), 3U * 5000U);
}

}  // namespace
}  // namespace mixrig::studio
