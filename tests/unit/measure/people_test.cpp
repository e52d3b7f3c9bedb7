// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/people.h"

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr std::array<double, 2> kEye{0, 0};
constexpr double kVariance_m2 = 0.0004;  // 20 mm

PersonFound found_at(int id, double x_m, double y_m) {
  return {id, x_m, y_m, kVariance_m2, kVariance_m2, 0};
}

TEST(PeopleJudge, errors_are_of_the_places_of_visible_people) {
  PeopleJudge judge;
  for (int i = 0; i < 30; ++i) {
    const std::vector<PersonThere> there{{0, 3, 0, 0.4}, {1, 3, 1, 0.01}};
    const std::vector<PersonFound> found{found_at(5, 3.03, 0.04), found_at(6, 3, 1.2)};
    judge.add(there, found, kEye, 0.04 * i);
  }
  const PeopleErrors e = judge.errors();
  EXPECT_EQ(e.judged, 30U);
  EXPECT_NEAR(e.rms_mm, 50, 1e-9);
  EXPECT_NEAR(e.p95_mm, 50, 0.1);
  EXPECT_NEAR(e.hidden_rms_mm, 200, 1e-9);
  EXPECT_NEAR(e.nees, 0.0025 / kVariance_m2, 1e-9);
  EXPECT_EQ(e.within_95_pct, 0);  // 6.25 is more than 5.99
  EXPECT_EQ(e.missed_pct, 0);
  EXPECT_EQ(e.false_pct, 0);
}

TEST(PeopleJudge, who_is_not_found_is_missed_after_a_while_and_a_far_track_is_false) {
  PeopleJudge judge;
  for (int i = 0; i < 2 * PeopleJudge::kGrace; ++i)
    judge.add(std::vector<PersonThere>{{0, 3, 0, 0.4}}, std::vector<PersonFound>{found_at(1, 4, 0)},
              kEye, 0.04 * i);
  const PeopleErrors e = judge.errors();
  EXPECT_EQ(e.judged, 0U);
  EXPECT_EQ(e.missed_pct, 100);
  EXPECT_EQ(e.false_pct, 100);
}

TEST(PeopleJudge, tells_a_swap_from_a_new_track) {
  PeopleJudge judge;
  const std::vector<PersonThere> apart{{0, 3, -1, 0.4}, {1, 3, 1, 0.4}};
  const std::vector<PersonFound> right{found_at(1, 3, -1), found_at(2, 3, 1)};
  const std::vector<PersonFound> swapped{found_at(2, 3, -1), found_at(1, 3, 1)};
  const std::vector<PersonFound> renamed{found_at(7, 3, -1), found_at(1, 3, 1)};
  judge.add(apart, right, kEye, 0.00);
  EXPECT_EQ(judge.errors().swaps, 0);
  judge.add(apart, swapped, kEye, 0.04);
  EXPECT_EQ(judge.errors().swaps, 2);
  judge.add(apart, renamed, kEye, 0.08);
  EXPECT_EQ(judge.errors().swaps, 2);
  EXPECT_EQ(judge.errors().broken, 1);
}

TEST(PeopleJudge, counts_who_crosses_whom_as_the_camera_sees_it) {
  PeopleJudge judge;
  for (int i = 0; i <= 20; ++i)
    judge.add(std::vector<PersonThere>{{0, 3, -1 + 0.1 * i, 0.4}, {1, 4, 0.05, 0.4}}, {}, kEye,
              0.04 * i);
  EXPECT_EQ(judge.errors().crossings, 1);
}

/// Visible for a second, hidden, visible for a second.
PeopleErrors after_hiding_s(double hidden_s, int id_after) {
  PeopleJudge judge;
  const int hidden = static_cast<int>(hidden_s / 0.04);
  for (int i = 0; i < 50 + hidden; ++i) {
    const bool is_hidden = i >= 25 && i < 25 + hidden;
    const std::vector<PersonThere> there{{0, 3, 0, is_hidden ? 0.01 : 0.4}};
    const int id = i < 25 ? 1 : is_hidden ? 0 : id_after;
    judge.add(there, {{found_at(id, 3, 0)}}, kEye, 0.04 * i);
  }
  return judge.errors();
}

TEST(PeopleJudge, counts_who_keeps_the_track_through_a_short_occlusion) {
  EXPECT_EQ(after_hiding_s(1.0, 1).occlusions, 1);
  EXPECT_EQ(after_hiding_s(1.0, 1).survived, 1);
  EXPECT_EQ(after_hiding_s(1.0, 2).occlusions, 1);
  EXPECT_EQ(after_hiding_s(1.0, 2).survived, 0);
  EXPECT_EQ(after_hiding_s(0.1, 2).occlusions, 0);
  EXPECT_EQ(after_hiding_s(2.0, 2).occlusions, 0);
}

TEST(PeopleJudge, says_where_the_mean_of_independent_samples_should_lie) {
  const PeopleErrors e = after_hiding_s(0.0, 1);
  EXPECT_EQ(e.samples, 4);  // 1.96 s
  // chi^2 of 8 degrees of freedom at 2.5 % and 97.5 %: 2.180 and 17.535.
  EXPECT_NEAR(e.nees_low, 2.180 / 4, 0.01);
  EXPECT_NEAR(e.nees_high, 17.535 / 4, 0.01);
}

}  // namespace
}  // namespace mixrig::measure
