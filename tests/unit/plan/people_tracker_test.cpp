// SPDX-License-Identifier: Apache-2.0
#include "extras/people/plan/people_tracker.h"

#include <algorithm>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "tests/unit/plan/standing_people.h"

namespace mixrig::plan {
namespace {

constexpr double kFrame_s = 0.04;
constexpr float kWall_m = 6;  ///< behind the people

/// The people of the last of some frames; the picture is borrowed by the tracker.
class Floor {
 public:
  std::span<const Person> frame(const std::vector<StandingBody>& bodies) {
    depth_m_ = draw_people(bodies);
    visible_m_ = depth_m_;
    for (int y = 0; y < visible_m_.height(); ++y)
      std::replace(visible_m_.row(y), visible_m_.row(y) + visible_m_.width(), 0.0F, kWall_m);
    people_ = tracker_.add({depth_m_, people_view(), people_camera(), visible_m_}, time_s_);
    time_s_ += kFrame_s;
    return people_;
  }
  const Person* near(double x_m, double y_m) const {
    for (const Person& p : people_)
      if ((p.on_floor_m - Eigen::Vector2d(x_m, y_m)).norm() < 0.35) return &p;
    return nullptr;
  }
  std::span<const Person> people() const { return people_; }
  PeopleTracker& tracker() { return tracker_; }

 private:
  PeopleTracker tracker_;
  Image<float> depth_m_, visible_m_;
  std::span<const Person> people_;
  double time_s_ = 0;
};

TEST(PeopleTracker, a_standing_body_is_where_its_axis_is_from_every_side) {
  for (int turn = 0; turn < 8; ++turn) {
    Floor floor;
    for (int i = 0; i < 20; ++i) floor.frame({{3.5, 0.6, turn * 0.4}});
    ASSERT_EQ(floor.people().size(), 1U) << turn;
    const Person& p = floor.people()[0];
    EXPECT_LT((p.on_floor_m - Eigen::Vector2d(3.5, 0.6)).norm(), 0.03) << turn;
    EXPECT_NEAR(p.height_m, 1.75, 0.04);
    EXPECT_EQ(p.sight, Sight::kSeen);
    EXPECT_GT(std::sqrt(p.covariance(0, 0)), 0.01);
  }
}

TEST(PeopleTracker, somebody_is_believed_after_a_few_frames_and_one_frame_is_nobody) {
  Floor floor;
  EXPECT_TRUE(floor.frame({{3, 0}}).empty());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(floor.frame({}).empty());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(floor.frame({{3, 0}}).empty());
  EXPECT_EQ(floor.frame({{3, 0}}).size(), 1U);
}

TEST(PeopleTracker, a_body_that_is_half_hidden_stays_where_it_is) {
  Floor floor;
  for (int i = 0; i < 25; ++i) floor.frame({{4, 0.5}});
  for (int i = 0; i < 25; ++i) floor.frame({{4, 0.5}, {2.5, 0.15}});  // covers its right half
  const Person* behind = floor.near(4, 0.5);
  ASSERT_NE(behind, nullptr);
  EXPECT_EQ(behind->sight, Sight::kPartly);
  EXPECT_LT((behind->on_floor_m - Eigen::Vector2d(4, 0.5)).norm(), 0.06);
}

/// One person passes behind the other within 1.3 s and is hidden for about half a second.
TEST(PeopleTracker, who_crosses_keeps_the_identity) {
  Floor floor;
  std::set<int> ids;
  int near_id = 0, far_id = 0;
  for (int i = 0; i < 100; ++i) {
    const double t = i * kFrame_s;
    const double near_y = -1.0 + 0.5 * t, far_y = 1.6 - 0.9 * t;
    floor.frame({{2.6, near_y}, {4.2, far_y}});
    for (const Person& p : floor.people()) ids.insert(p.id);
    if (i == 20) near_id = floor.near(2.6, near_y)->id, far_id = floor.near(4.2, far_y)->id;
  }
  EXPECT_EQ(ids.size(), 2U);
  ASSERT_NE(floor.near(2.6, -1.0 + 0.5 * 99 * kFrame_s), nullptr);
  EXPECT_EQ(floor.near(2.6, -1.0 + 0.5 * 99 * kFrame_s)->id, near_id);
  EXPECT_EQ(floor.near(4.2, 1.6 - 0.9 * 99 * kFrame_s)->id, far_id);
  EXPECT_NE(near_id, far_id);
}

/// A second of full occlusion: a broad body stands in front.
TEST(PeopleTracker, a_track_lives_through_a_second_of_occlusion) {
  Floor floor;
  const auto walker = [](int i) { return StandingBody{4.2, -1.4 + 0.5 * i * kFrame_s}; };
  StandingBody screen{2.2, 0, 0};
  screen.half_width_m = 0.35;
  int id = 0, hidden = 0;
  for (int i = 0; i < 150; ++i) {
    floor.frame({walker(i), screen});
    const Person* p = floor.near(walker(i).x_m, walker(i).y_m);
    if (i == 20) id = p->id;
    if (i < 20) continue;
    ASSERT_NE(p, nullptr) << i;
    EXPECT_EQ(p->id, id) << i;
    hidden += p->sight == Sight::kHidden ? 1 : 0;
  }
  EXPECT_GT(hidden, 20);
}

TEST(PeopleTracker, people_who_touch_stay_two) {
  Floor floor;
  for (int i = 0; i < 80; ++i) {
    const double apart = std::max(0.23, 0.8 - 0.5 * i * kFrame_s);
    floor.frame({{3.4, apart}, {3.4, -apart}});
  }
  EXPECT_EQ(floor.people().size(), 2U);
  EXPECT_NE(floor.near(3.4, 0.23), nullptr);
  EXPECT_NE(floor.near(3.4, -0.23), nullptr);
}

TEST(PeopleTracker, two_who_enter_as_one_cluster_are_two_heads) {
  Floor floor;
  for (int i = 0; i < 10; ++i) floor.frame({{3.4, 0.26}, {3.4, -0.26}});
  EXPECT_EQ(floor.people().size(), 2U);
}

TEST(PeopleTracker, who_leaves_the_picture_or_an_open_floor_is_gone) {
  Floor floor;
  for (int i = 0; i < 20; ++i) floor.frame({{3.5, 0}});
  ASSERT_EQ(floor.people().size(), 1U);
  for (int i = 0; i < 15; ++i) floor.frame({});
  EXPECT_TRUE(floor.people().empty());
}

TEST(PeopleTracker, small_things_and_the_floor_are_nobody) {
  Floor floor;
  StandingBody ball{3, 0};
  ball.height_m = 0.25, ball.half_width_m = ball.half_depth_m = 0.12;
  for (int i = 0; i < 10; ++i) floor.frame({ball});
  EXPECT_TRUE(floor.people().empty());
}

TEST(PeopleTracker, depth_that_is_no_number_changes_nothing) {
  PeopleTracker tracker;
  Image<float> depth_m(people_view().size_px, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(tracker.add({depth_m, people_view(), people_camera()}, 0).empty());
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x)
      depth_m.at(x, y) = x % 2 == 0 ? std::numeric_limits<float>::infinity() : -1.0F;
  EXPECT_TRUE(tracker.add({depth_m, people_view(), people_camera()}, 0.04).empty());
}

}  // namespace
}  // namespace mixrig::plan
