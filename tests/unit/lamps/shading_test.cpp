// SPDX-License-Identifier: Apache-2.0
// Intensities from the shading of a box that is lit by formula.
#include "host/room/lamps/shading.h"

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "tests/unit/lamps/drawn_box.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector3d;
using test::DrawnBox;

constexpr double kAmbient = 0.15;

/// A panel's light at a place: 12 x 12 points, the box's own sum.
double panel_light(const DrawnBox& box, const DrawnBox::Panel& lamp, const Vector3d& p,
                   const Vector3d& normal) {
  double sum = 0;
  constexpr int kSide = 12;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vector3d at = lamp.middle_m + Vector3d(((i + 0.5) / kSide - 0.5) * box.panel_m.x(),
                                                   ((j + 0.5) / kSide - 0.5) * box.panel_m.y(), 0);
      const Vector3d to = at - p;
      const double d = to.norm();
      sum += std::max(0.0, normal.dot(to) / d) * std::max(0.0, to.z() / d) / (d * d);
    }
  return lamp.intensity * sum / (kSide * kSide);
}

/// The box's panorama, lit; walls of different albedo, with a checked pattern of 20 %.
RoomSurfaces lit_room(const DrawnBox& box, double exposure) {
  model::Panorama p = box.panorama();
  const Size size = p.size();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Vector3d ray = model::direction_of(size, x, y);
      const auto hit = box.walls(box.scan_m(), ray);
      const Vector3d at = box.scan_m() + hit.t * ray;
      double light = kAmbient;
      for (const auto& lamp : box.lamps) light += panel_light(box, lamp, at, hit.normal);
      const double wall = 0.5 + 0.1 * hit.normal.dot(Vector3d(1, 0.5, -0.7));
      const int check = static_cast<int>(std::floor(6 * at.x()) + std::floor(6 * at.y()) +
                                         std::floor(6 * at.z()));
      const double albedo = wall * (check % 2 == 0 ? 1.0 : 0.8);
      const auto grey = srgb_byte_from_linear(static_cast<float>(exposure * albedo * light));
      p.color.at(x, y) = {grey, grey, grey};
      if (box.on_panel(at)) p.color.at(x, y) = {255, 255, 255};
    }
  return {std::move(p), {Eigen::Quaterniond::Identity(), box.scan_m()}};
}

FoundLamp found(const DrawnBox& box, const Vector3d& middle) {
  FoundLamp lamp;
  lamp.position_m = middle, lamp.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  lamp.direction = -Vector3d::UnitZ(), lamp.size_m = box.panel_m;
  return lamp;
}

TEST(Shading, GivesRelativeIntensitiesAndAmbient) {
  const DrawnBox box;
  const RoomSurfaces room = lit_room(box, 0.7);
  const std::vector<FoundLamp> lamps{found(box, box.lamps[0].middle_m),
                                     found(box, box.lamps[1].middle_m)};
  const auto light = measure_light(room, lamps);
  ASSERT_TRUE(light.usable()) << light.verdict.reason;
  const auto& k = light.value.intensity;
  EXPECT_NEAR(k[0].y() / k[1].y(), 0.5, 0.03);
  EXPECT_NEAR(light.value.ambient.y() / k[1].y(), kAmbient / 4, 0.008);
  EXPECT_GE(light.value.planes, 4);
}

TEST(Shading, ALampThatIsOffGivesNoLight) {
  const DrawnBox box;
  const RoomSurfaces room = lit_room(box, 0.7);
  const std::vector<FoundLamp> lamps{found(box, box.lamps[0].middle_m),
                                     found(box, box.lamps[1].middle_m),
                                     found(box, {1.2, 3.2, 2.9})};
  const auto light = measure_light(room, lamps);
  ASSERT_TRUE(light.usable()) << light.verdict.reason;
  EXPECT_LT(light.value.intensity[2].y(), 0.04 * light.value.intensity[1].y());
  EXPECT_GT(light.value.largest_share[1], 0.3);
}

TEST(Shading, SaysWhereItCannotTell) {
  const DrawnBox box;
  const RoomSurfaces room = lit_room(box, 0.7);
  EXPECT_FALSE(measure_light(room, {}).usable());
  // Two lamps at one place.
  const std::vector<FoundLamp> same{found(box, box.lamps[0].middle_m),
                                    found(box, box.lamps[0].middle_m)};
  EXPECT_FALSE(measure_light(room, same).usable());
  model::Panorama dark = box.panorama();
  dark.color.reset(dark.size(), {0, 0, 0});
  const RoomSurfaces unlit(std::move(dark), {});
  EXPECT_FALSE(measure_light(unlit, same).usable());
}

}  // namespace
}  // namespace mixrig::lights
