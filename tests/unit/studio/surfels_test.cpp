// SPDX-License-Identifier: Apache-2.0
#include "studio/stage/surfels.h"

#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace mixrig::studio {
namespace {

/// One pixel spans a whole period of a texture whose first texel of four is white; at the corners
/// of the pixel the texture is black.
TEST(Surfels, AnObjectHasTheMeanAlbedoOfAPixelAndNotThatOfItsCorners) {
  VirtualObject object;
  object.meshes.emplace_back().texture.reset({4, 1});
  object.meshes[0].texture.at(0, 0) = {255, 255, 255};
  const Materials materials(1, {}, &object);
  Mesh mesh;
  add_quad(mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, {Kind::kObject});  // a period is a metre
  const TraceDevice device = *TraceDevice::create();
  TraceScene scene(device);
  scene.set(mesh);
  Optics optics;
  optics.size_px = {1, 1}, optics.fx_px = optics.fy_px = 2;
  const RayGrid grid(optics);
  geometry::Pose pose;  // looks down at the origin from 2 m above
  pose.rotation = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  pose.translation_m = {0, 0, 2};
  Crew crew(1);
  SurfelMap map;
  map.build(scene, materials, camera_rays(grid, pose), {0, 0, 1, 1}, crew);
  ASSERT_EQ(map.at(0, 0).size(), 1U) << "no edge";
  EXPECT_NEAR(map.at(0, 0)[0].albedo.y(), 0.25F, 1e-3F);
}

}  // namespace
}  // namespace mixrig::studio
