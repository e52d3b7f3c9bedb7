// SPDX-License-Identifier: Apache-2.0
// Faults of a sweep of a box are reported by name and place; a sound sweep has none.
#include "host/room/scan/shape/room_findings.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "tests/support/box_views.h"
#include "tests/support/each_pixel.h"

namespace mixrig::model {
namespace {

std::vector<Finding> faults_of(const std::vector<ScanView>& views,
                               std::optional<Size> field_deg = {}) {
  Crew crew(2);
  const auto camera = test::box_camera();
  const Alignment alignment = align(views, camera, camera, 0.05 * kDeg, crew);
  const Panorama panorama = make_panorama(views, camera, camera, {360}, crew);
  return find_faults({views, camera, alignment, panorama, field_deg});
}

const Finding* find(const std::vector<Finding>& list, FindingKind kind, int view = 0) {
  const auto at = std::find_if(list.begin(), list.end(),
                               [&](const Finding& f) { return f.kind == kind && f.view == view; });
  return at == list.end() ? nullptr : &*at;
}

std::vector<ScanView> sound_box() { return test::box_views({.noise_m = 0.006, .textured = true}); }

TEST(RoomFindings, ASoundSweepHasNone) {
  const auto found = faults_of(sound_box());
  for (const Finding& f : found) ADD_FAILURE() << text_of(f);
}

TEST(RoomFindings, AWrongAngleIsNamed) {
  auto views = sound_box();
  turn(Eigen::Vector3d(0, 0, 0.5) * kDeg, views[22]);
  const auto found = faults_of(views);
  const Finding* fault = find(found, FindingKind::kTurnedView, 23);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(fault->value, 0.5, 0.06);
  EXPECT_NEAR(fault->azimuth_deg, 72.5, 1);
  EXPECT_NE(text_of(*fault).find("view 23 at azimuth 73, elevation 0 deg: its angles disagree"),
            std::string::npos)
      << text_of(*fault);
  EXPECT_EQ(found.size(), 1U);
}

TEST(RoomFindings, ADroppedViewLeavesAnAreaThatNoViewShows) {
  auto views = sound_box();
  views.erase(views.begin() + 20);  // straight ahead
  const auto found = faults_of(views);
  const Finding* fault = find(found, FindingKind::kUnseen);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(fault->azimuth_deg, 0, 6);
  EXPECT_NEAR(fault->elevation_deg, 0, 6);
  EXPECT_GT(fault->value, 20);
}

std::vector<ScanView> five_views() {
  std::vector<ScanView> views;
  for (int pan = -2; pan <= 2; ++pan)
    views.push_back(test::box_view(0.6 * pan, 0, {.noise_m = 0.006, .textured = true}));
  return views;
}

TEST(RoomFindings, WhatLiesOutsideASweepIsNoFault) {
  EXPECT_EQ(find(faults_of(five_views()), FindingKind::kUnseen), nullptr);
}

TEST(RoomFindings, AViewDroppedAtTheBorderIsNamedWhereTheFieldIsKnown) {
  auto views = five_views();
  constexpr Size kField{200, 40};  // views are 69 x 59 degrees
  EXPECT_EQ(find(faults_of(views, kField), FindingKind::kUnseen), nullptr);
  views.pop_back();  // the leftmost
  EXPECT_EQ(find(faults_of(views), FindingKind::kUnseen), nullptr);
  const auto found = faults_of(views, kField);
  const Finding* fault = find(found, FindingKind::kUnseen);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(fault->azimuth_deg, 84, 4);  // from 69 to 98.5
  EXPECT_NEAR(fault->elevation_deg, 0, 4);
  EXPECT_GT(fault->value, 500);
}

TEST(RoomFindings, GlassIsTheWallAroundItAndIsNamed) {
  auto views = sound_box();
  for (ScanView& view : views)
    for (int y = 0; y < test::kBoxRows; ++y)
      for (int x = 0; x < test::kBoxColumns; ++x) {
        const Eigen::Vector3d ray =
            view.base_from_tof.rotation * Eigen::Vector3d((x - 47.5) / 70, (y - 39.5) / 70, 1);
        const Eigen::Vector3d at = ray / std::abs(ray.x());  // of the walls to both sides
        if (ray.x() > 0 && std::abs(at.y()) < 0.4 && std::abs(at.z()) < 0.4)
          view.distance_m.at(x, y) = 0;
      }
  const auto found = faults_of(views);
  const Finding* fault = find(found, FindingKind::kWithoutDepth);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(fault->azimuth_deg, -90, 6);
  EXPECT_GT(fault->value, 300);
  Crew crew(2);
  const Panorama p = make_panorama(views, test::box_camera(), test::box_camera(), {360}, crew);
  int glass = 0;
  for (const auto [x, y] : test::each_pixel({0, 0}, {p.size().width, p.size().height})) {
    const Eigen::Vector3d ray = direction_of(p.size(), x, y);
    const Eigen::Vector3d at = ray / std::abs(ray.x());
    if (ray.x() <= 0 || std::abs(at.y()) > 0.36 || std::abs(at.z()) > 0.36) continue;
    EXPECT_NEAR(p.distance_m.at(x, y), test::to_wall_m({0, 0, 0}, ray), 0.01);
    EXPECT_GT(p.sigma_m.at(x, y), 0);
    EXPECT_EQ(p.views.at(x, y), 0);
    ++glass;
  }
  EXPECT_GT(glass, 1000);
}

TEST(RoomFindings, AMirrorShowsRoomBehindAWall) {
  auto views = sound_box();
  for (ScanView& view : views)
    for (int y = 0; y < test::kBoxRows; ++y)
      for (int x = 0; x < test::kBoxColumns; ++x) {
        const Eigen::Vector3d ray =
            (view.base_from_tof.rotation * Eigen::Vector3d((x - 47.5) / 70, (y - 39.5) / 70, 1))
                .normalized();
        const Eigen::Vector3d at = ray / std::abs(ray.y());
        if (ray.y() < 0 && std::abs(at.x()) < 0.3 && std::abs(at.z()) < 0.3)
          view.distance_m.at(x, y) += static_cast<float>(1.5 / -ray.y());
      }
  const auto found = faults_of(views);
  const Finding* fault = find(found, FindingKind::kBehindWall);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(std::abs(fault->azimuth_deg), 180, 6);
  EXPECT_GT(fault->value, 400);
}

/// A sheet 1 m before the wall behind, 0.6 m wide, from `lowest_z` on, with noise of its own.
std::vector<Finding> faults_with_sheet(double lowest_z, double noise_m) {
  auto views = sound_box();
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, noise_m);
  for (ScanView& view : views)
    for (int y = 0; y < test::kBoxRows; ++y)
      for (int x = 0; x < test::kBoxColumns; ++x) {
        const Eigen::Vector3d ray =
            (view.base_from_tof.rotation * Eigen::Vector3d((x - 47.5) / 70, (y - 39.5) / 70, 1))
                .normalized();
        float& distance_m = view.distance_m.at(x, y);
        const Eigen::Vector3d at = ray / std::abs(ray.y());
        if (ray.y() < 0 && std::abs(at.x()) < 0.3 && at.z() > lowest_z && at.z() < 0.3)
          distance_m = std::min(distance_m, static_cast<float>(1 / -ray.y() + noise(random))),
          view.sigma_m.at(x, y) = static_cast<float>(noise_m);
      }
  return faults_of(views);
}

TEST(RoomFindings, WhatFloatsBeforeAWallIsNamedAndWhatStandsIsNot) {
  const auto hanging = faults_with_sheet(-0.3, 0.004), standing = faults_with_sheet(-5, 0.004);
  const Finding* fault = find(hanging, FindingKind::kBeforeWall);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(std::abs(fault->azimuth_deg), 180, 6);
  EXPECT_EQ(find(hanging, FindingKind::kWrapped), nullptr);
  EXPECT_EQ(find(standing, FindingKind::kBeforeWall), nullptr);
}

/// Beyond the unambiguous range a mirror's depth wraps around to less than the wall's; its light
/// has come a longer way than its distance says, so it is noisier.
TEST(RoomFindings, DepthOfAMirrorThatWrappedAroundIsLeftOutAndNamed) {
  const auto found = faults_with_sheet(-0.3, 0.04);
  const Finding *fault = find(found, FindingKind::kWrapped),
                *unknown = find(found, FindingKind::kWithoutDepth);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(std::abs(fault->azimuth_deg), 180, 6);
  EXPECT_GT(fault->value, 500);  // of 33 x 33 degrees
  EXPECT_EQ(find(found, FindingKind::kBeforeWall), nullptr);
  ASSERT_NE(unknown, nullptr);
  EXPECT_NEAR(std::abs(unknown->azimuth_deg), 180, 6);
}

TEST(RoomFindings, ALampAndAnEmptyViewAreNamed) {
  auto views = sound_box();
  for (int y = 10; y < 20; ++y)
    for (int x = 10; x < 20; ++x) views[24].plate.at(x, y) = {255, 255, 255};
  for (int y = 0; y < test::kBoxRows - 20; ++y)
    for (int x = 0; x < test::kBoxColumns; ++x) views[26].distance_m.at(x, y) = 0;
  const auto found = faults_of(views);
  const Finding* lamp = find(found, FindingKind::kSaturatedView, 25);
  ASSERT_NE(lamp, nullptr);
  EXPECT_NEAR(lamp->value, 100.0 * 100 / (96 * 80), 0.01);
  // At (14.5, 14.5) of 96x80 pixels of 1/70 rad: 25 degrees to the left, 18 upwards.
  const Eigen::Vector3d at =
      views[24].base_from_target.rotation * Eigen::Vector3d(-33.0 / 70, -25.0 / 70, 1);
  EXPECT_NEAR(lamp->azimuth_deg, std::atan2(-at.x(), at.y()) / kDeg, 0.1);
  EXPECT_NEAR(lamp->elevation_deg, std::asin(at.z() / at.norm()) / kDeg, 0.1);
  const Finding* empty = find(found, FindingKind::kEmptyView, 27);
  ASSERT_NE(empty, nullptr);
  EXPECT_NEAR(empty->value, 25, 0.1);
}

TEST(RoomFindings, WhatAShorterExposureShowsIsNotSaturated) {
  auto views = sound_box();
  const std::uint16_t white = half_of_float(4), limit = half_of_float(16);
  for (ScanView* view : {&views[23], &views[24]}) {
    view->light.reset(view->plate.size(), {white, white, white});
    view->light_limit = 16;
    for (int y = 10; y < 20; ++y)
      for (int x = 10; x < 20; ++x) view->plate.at(x, y) = {255, 255, 255};
  }
  for (int y = 10; y < 14; ++y)
    for (int x = 10; x < 20; ++x) views[24].light.at(x, y) = {limit, limit, limit};
  const auto found = faults_of(views);
  EXPECT_EQ(find(found, FindingKind::kSaturatedView, 24), nullptr);
  const Finding* lamp = find(found, FindingKind::kSaturatedView, 25);
  ASSERT_NE(lamp, nullptr);
  EXPECT_NEAR(lamp->value, 100.0 * 40 / (96 * 80), 0.01);
}

}  // namespace
}  // namespace mixrig::model
