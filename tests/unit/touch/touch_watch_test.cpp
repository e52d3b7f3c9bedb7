// SPDX-License-Identifier: Apache-2.0
// People by formula before a camera, and boxes.
#include "extras/people/touch/touch_watch.h"

#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "extras/people/plan/people_tracker.h"
#include "tests/unit/plan/standing_people.h"

namespace mixrig::touch {
namespace {

constexpr double kFrame_s = 0.04;
constexpr geometry::DepthNoise kNoise{0.00034, 0.00174, 0.00018};

Shape crate(float x_m = 0.4F, float y_m = 0.4F, float z_m = 1.2F) {
  return box_shape(
      {Eigen::Vector3f(-x_m / 2, -y_m / 2, 0), Eigen::Vector3f(x_m / 2, y_m / 2, z_m)});
}
geometry::Pose at(double x_m, double y_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, y_m, 0}};
}

/// Depth with the noise of the sensor, and depth between a person and a wall behind at the border.
void add_noise(Image<float>& depth_m, std::mt19937& random) {
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> between(0, 1);
  const Image<float> clean = depth_m;
  const auto is_seen = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < clean.width() && y < clean.height() && clean.at(x, y) > 0;
  };
  for (int y = 0; y < clean.height(); ++y)
    for (int x = 0; x < clean.width(); ++x) {
      if (!is_seen(x, y)) continue;
      float& z = depth_m.at(x, y);
      z += static_cast<float>(kNoise.sigma_m(z)) * normal(random);
      if (!is_seen(x - 1, y) || !is_seen(x + 1, y)) z += between(random) * 0.6F;
    }
}

const geometry::Pinhole kView{{160, 128}, 125, 125, 79.5, 63.5};

class TouchWatchTest : public ::testing::Test {
 protected:
  void see(const std::vector<plan::StandingBody>& bodies) {
    Image<float> depth_m = plan::draw_people(bodies, kView);
    if (noisy_) add_noise(depth_m, random_);
    const plan::SegmentedView seen{depth_m, kView, plan::people_camera(), depth_m};
    const auto people = tracker_.add(seen, time_s_);
    people_ = people.size();
    for (const Event& e : watch_->add({seen, people, poses_, kNoise, time_s_}))
      events_.push_back(e);
    time_s_ += kFrame_s;
  }
  std::vector<Event> of(EventKind kind) const {
    std::vector<Event> out;
    for (const Event& e : events_)
      if (e.kind == kind) out.push_back(e);
    return out;
  }
  std::optional<TouchWatch> watch_;
  std::vector<geometry::Pose> poses_;
  plan::PeopleTracker tracker_;
  std::size_t people_ = 0;
  std::mt19937 random_{3};
  bool noisy_ = true;
  double time_s_ = 0;
  std::vector<Event> events_;
};

/// Walks towards the camera into the crate at 1 m/s: its front is 0.13 m before its axis.
TEST_F(TouchWatchTest, FirstContactAndDepthByFormula) {
  watch_.emplace(std::vector{crate()});
  poses_ = {at(2.0, 0)};
  const double start_m = 3.0, face_m = 2.2, half_m = 0.13;
  const double contact_s = start_m - half_m - face_m;
  while (time_s_ < 0.85) see({{std::max(2.25, start_m - time_s_), 0}});
  const auto enters = of(EventKind::kEnter);
  ASSERT_EQ(enters.size(), 1U);
  EXPECT_NEAR(enters[0].time_s, contact_s, kFrame_s);
  EXPECT_NEAR(enters[0].at_m.x(), face_m, 0.05);
  EXPECT_EQ(enters[0].evidence, Evidence::kSurface);
  EXPECT_EQ(of(EventKind::kHit).size(), 1U);
  EXPECT_NEAR(of(EventKind::kHit)[0].speed_m_s, 1.0, 0.3);
  for (int i = 0; i < 30; ++i) see({{2.25, 0}});  // front 0.08 m inside
  ASSERT_EQ(of(EventKind::kStay).size(), 2U);
  const Event stay = of(EventKind::kStay).back();
  EXPECT_NEAR(stay.depth_m, face_m - (2.25 - half_m), 2 * stay.sigma_m);
  for (int i = 0; i < 25; ++i) see({{2.25 + 0.04 * i, 0}});
  EXPECT_EQ(of(EventKind::kLeave).size(), 1U);
}

TEST_F(TouchWatchTest, NoEventInANearPass) {
  watch_.emplace(std::vector{crate(), crate()});
  poses_ = {at(2.0, 0), at(2.9, 0)};  // between them: 0.15 m before and behind the body
  for (int i = 0; i < 500; ++i) see({{2.48, 0.5 * std::sin(0.05 * i)}});
  EXPECT_TRUE(events_.empty()) << events_.size();
  EXPECT_EQ(people_, 1U);
}

TEST_F(TouchWatchTest, TwoPeopleAreToldApart) {
  watch_.emplace(std::vector{crate(0.4F, 1.0F)});
  poses_ = {at(2.0, 0)};
  const auto left_x = [&] { return std::max(2.25, 3.0 - time_s_); };
  const auto right_x = [&] { return std::max(2.25, 3.4 - time_s_); };
  while (time_s_ < 1.6) see({{left_x(), 0.35}, {right_x(), -0.35}});
  const auto enters = of(EventKind::kEnter);
  ASSERT_EQ(enters.size(), 2U);
  EXPECT_NE(enters[0].other, enters[1].other);
  EXPECT_NEAR(enters[0].time_s, 0.67, kFrame_s);
  EXPECT_NEAR(enters[1].time_s, 1.07, kFrame_s);
  EXPECT_GT(enters[0].at_m.y(), 0.1);
  EXPECT_LT(enters[1].at_m.y(), -0.1);
}

TEST_F(TouchWatchTest, AnObjectThatVanishesIsLeft) {
  watch_.emplace(std::vector{crate()});
  poses_ = {at(2.0, 0)};
  for (int i = 0; i < 10; ++i) see({{2.25, 0}});
  ASSERT_EQ(of(EventKind::kEnter).size(), 1U);
  poses_.clear();
  see({{2.25, 0}});
  EXPECT_EQ(of(EventKind::kLeave).size(), 1U);
  for (int i = 0; i < 5; ++i) see({{2.25, 0}});
  EXPECT_EQ(of(EventKind::kEnter).size(), 1U);
  poses_ = {at(2.0, 0)};
  for (int i = 0; i < 5; ++i) see({{2.25, 0}});
  EXPECT_EQ(of(EventKind::kEnter).size(), 2U);
}

/// A person who walks backwards into a crate hides the touching side from the camera.
TEST_F(TouchWatchTest, TheUnseenBackIsToldByTheProxy) {
  watch_.emplace(std::vector{crate(0.3F, 1.0F)});
  poses_ = {at(3.0, 0)};
  while (time_s_ < 1.0) see({{2.0 + time_s_, 0}});
  const auto enters = of(EventKind::kEnter);
  ASSERT_GE(enters.size(), 1U);
  EXPECT_EQ(enters[0].evidence, Evidence::kProxy);
  EXPECT_GT(enters[0].sigma_m, 0.04);
  EXPECT_NEAR(enters[0].time_s, 2.85 - 0.13 - 2.0, 3 * enters[0].sigma_m);
}

TEST_F(TouchWatchTest, ObjectsTouchEachOtherAndTheRoom) {
  watch_.emplace(std::vector{crate(), crate()});
  std::vector<plan::RoomPoint> wall;
  for (float y = -1; y < 1; y += 0.02F)
    for (float z = 0; z < 2; z += 0.02F) wall.push_back({{2.1F, y, z}, {}});
  watch_->set_room(wall);
  poses_ = {at(2.0, 0), at(3.0, 0)};
  see({});
  ASSERT_EQ(events_.size(), 1U);
  EXPECT_EQ(events_[0].against, Against::kRoom);
  EXPECT_EQ(events_[0].object, 0);
  EXPECT_NEAR(events_[0].depth_m, 0.1, 0.005);
  for (int i = 1; i <= 10; ++i) poses_[1] = at(3.0 - 0.07 * i, 0), see({});
  const auto enters = of(EventKind::kEnter);
  ASSERT_EQ(enters.size(), 2U);
  EXPECT_EQ(enters[1].against, Against::kObject);
  EXPECT_EQ(enters[1].other, 1);
  EXPECT_NEAR(enters[1].time_s, kFrame_s * 0.6 / 0.07, 0.5 * kFrame_s);
  for (int i = 1; i <= 10; ++i) poses_[1] = at(2.3 + 0.07 * i, 0), see({});
  EXPECT_EQ(of(EventKind::kLeave).size(), 1U);
}

}  // namespace
}  // namespace mixrig::touch
