// SPDX-License-Identifier: Apache-2.0
// Faults of a sweep of a box are said by name and place, and a sound one has none.
#include "host/model/room_findings.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "tests/support/box_views.h"

namespace mixrig::model {
namespace {

std::vector<Finding> faults_of(const std::vector<ScanView>& views) {
  Crew crew(2);
  const auto camera = test::box_camera();
  const Alignment alignment = align(views, camera, camera, 0.05 * kDeg, crew);
  return find_faults(views, alignment, make_panorama(views, camera, camera, {360}, crew));
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

TEST(RoomFindings, WhatLiesOutsideASweepIsNoFault) {
  std::vector<ScanView> views;
  for (int pan = -2; pan <= 2; ++pan)
    views.push_back(test::box_view(0.6 * pan, 0, {.noise_m = 0.006, .textured = true}));
  EXPECT_EQ(find(faults_of(views), FindingKind::kUnseen), nullptr);
}

TEST(RoomFindings, GlassStaysUnknownAndIsNamed) {
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
  const Finding* empty = find(found, FindingKind::kEmptyView, 27);
  ASSERT_NE(empty, nullptr);
  EXPECT_NEAR(empty->value, 25, 0.1);
}

}  // namespace
}  // namespace mixrig::model
