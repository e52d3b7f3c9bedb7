// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/contact.h"

#include <gtest/gtest.h>

namespace mixrig::touch {
namespace {

constexpr double kStep_s = 0.04;

class ContactTest : public ::testing::Test {
 protected:
  void see(std::optional<double> gap_m, bool hidden = false) {
    std::optional<Gap> gap;
    if (gap_m) gap = Gap{*gap_m, 0.01, {1, 2, 3}, Evidence::kSurface};
    contact_.add(gap, hidden, time_s_, {}, events_);
    time_s_ += kStep_s;
  }
  int count(EventKind kind) const {
    return static_cast<int>(std::count_if(events_.begin(), events_.end(),
                                          [&](const Event& e) { return e.kind == kind; }));
  }
  Contact contact_{Against::kPerson, 4, 7};
  double time_s_ = 0;
  std::vector<Event> events_;
};

TEST_F(ContactTest, EntersAtTheTimeTheGapClosed) {
  for (int i = 0; i < 8; ++i) see(0.13 - 0.04 * i);  // 1 m/s: zero at 0.13 s
  ASSERT_EQ(count(EventKind::kEnter), 1);
  const Event& e = events_[0];
  EXPECT_EQ(e.object, 4);
  EXPECT_EQ(e.other, 7);
  EXPECT_NEAR(e.time_s, 0.13, 1e-6);
  EXPECT_NEAR(e.speed_m_s, 1.0, 1e-6);
  EXPECT_NEAR(e.depth_m, 0.03, 1e-6);
  ASSERT_EQ(count(EventKind::kHit), 1);
  EXPECT_EQ(events_[1].time_s, e.time_s);
}

TEST_F(ContactTest, SlowContactIsNoHit) {
  for (int i = 0; i < 30; ++i) see(0.02 - 0.004 * i);  // 0.1 m/s
  EXPECT_EQ(count(EventKind::kEnter), 1);
  EXPECT_EQ(count(EventKind::kHit), 0);
}

TEST_F(ContactTest, OneSureFrameBesideOneThatOverlapsIsEnough) {
  see(0.05), see(-0.004), see(-0.03);
  ASSERT_EQ(count(EventKind::kEnter), 1);
  EXPECT_NEAR(events_[0].time_s, kStep_s * 0.05 / 0.054, 1e-6);
}

TEST_F(ContactTest, OneFrameAndWhatIsUnsureAreNoContact) {
  for (int i = 0; i < 20; ++i) see(0.1), see(i == 10 ? -0.2 : -0.009), see(0.1);
  for (int i = 0; i < 20; ++i) see(-0.009);
  EXPECT_TRUE(events_.empty());
}

TEST_F(ContactTest, TremorAroundTheSurfaceDoesNotChatter) {
  see(0.1);
  for (int i = 0; i < 100; ++i) see(i % 2 ? -0.02 : -0.02 + 0.045);  // below the leaving gap
  EXPECT_LE(count(EventKind::kEnter), 1);
  see(-0.02), see(-0.02);
  ASSERT_EQ(count(EventKind::kEnter), 1);
  for (int i = 0; i < 100; ++i) see(i % 3 ? 0.05 : -0.02);  // apart for two frames at most
  EXPECT_EQ(count(EventKind::kEnter), 1);
  EXPECT_EQ(count(EventKind::kLeave), 0);
  const double left_s = time_s_;
  for (int i = 0; i < 10; ++i) see(0.05);
  ASSERT_EQ(count(EventKind::kLeave), 1);
  EXPECT_NEAR(events_.back().time_s, left_s, kStep_s + 1e-9);
  EXPECT_NEAR(events_.back().depth_m, 0.02, 1e-9);
}

TEST_F(ContactTest, StaysAreToldTwiceASecond) {
  see(0.01);
  for (int i = 0; i < 77; ++i) see(-0.05);  // three seconds
  EXPECT_EQ(count(EventKind::kStay), 5);
  EXPECT_EQ(count(EventKind::kLeave), 0);
}

TEST_F(ContactTest, WhoIsHiddenStays) {
  see(0.01), see(-0.05), see(-0.05);
  for (int i = 0; i < 25; ++i) see(std::nullopt, true);
  EXPECT_EQ(count(EventKind::kLeave), 0);
  for (int i = 0; i < 5; ++i) see(std::nullopt);
  EXPECT_EQ(count(EventKind::kLeave), 1);
}

TEST_F(ContactTest, EndLeavesOnce) {
  see(0.01), see(-0.05), see(-0.06);
  contact_.end(time_s_, events_);
  contact_.end(time_s_, events_);
  EXPECT_EQ(count(EventKind::kLeave), 1);
  EXPECT_NEAR(events_.back().depth_m, 0.06, 1e-9);
}

}  // namespace
}  // namespace mixrig::touch
