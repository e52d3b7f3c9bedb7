// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/statue_room.h"

#include <cmath>

namespace mixrig::test {
namespace {

constexpr int kRings = 50, kSectors = 50;

}  // namespace

StatueRoom::StatueRoom(const Options& options) : RoomSetup(options) {
  skin_.reset({64, 64});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      skin_.at(x, y) = (x / 8 + y / 8) % 2 ? Rgb8{200, 180, 150} : Rgb8{120, 130, 160};
  const glm::vec3 radii_m(0.25F, 0.6F, 0.25F);
  for (int j = 0; j <= kRings; ++j)
    for (int i = 0; i <= kSectors; ++i) {
      const float u = static_cast<float>(i) / kSectors, v = static_cast<float>(j) / kRings;
      const float around = u * 2 * static_cast<float>(M_PI), down = v * static_cast<float>(M_PI);
      const glm::vec3 n(std::sin(down) * std::cos(around), -std::cos(down),
                        std::sin(down) * std::sin(around));
      positions_m_.push_back(radii_m * n);
      normals_.push_back(glm::normalize(n / radii_m));
      uv_.emplace_back(3 * u, 3 * v);
    }
  for (int j = 0; j < kRings; ++j)
    for (int i = 0; i < kSectors; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (kSectors + 1) + i), b = a + kSectors + 1;
      for (const std::uint32_t k : {a, a + 1, b, b, a + 1, b + 1}) indices_.push_back(k);
    }
  render::VirtualObject statue;
  statue.meshes.push_back({positions_m_, normals_, uv_, indices_, glm::vec3(1), skin_, false});
  statue.world_from_object.translation_m = {0.3, 0.9, 2.9};
  setup.objects = {statue};
  setup.light.lamps.clear();
  for (const double x_m : {-1.2, 1.2})
    for (const double z_m : {1.5, 3.6})
      setup.light.lamps.push_back(
          {{x_m, -1.39, z_m}, Eigen::Vector3d::UnitY(), {0.6, 0.6}, {2.0F, 1.9F, 1.8F}});
}

}  // namespace mixrig::test
