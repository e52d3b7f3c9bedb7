// SPDX-License-Identifier: Apache-2.0
// Visibility of a lamp past a person.
#include "host/room/lamps/body_columns.h"

#include <vector>

#include <gtest/gtest.h>

namespace mixrig::lights {
namespace {

TEST(BodyColumns, HideWhatLiesBehindThemAndNothingElse) {
  std::vector<Eigen::Vector3d> person_m;  // the front of one who is 1.8 m tall
  for (int i = 0; i <= 18; ++i)
    for (int j = -2; j <= 2; ++j) person_m.emplace_back(2.0, 1.0 + 0.1 * j, 0.1 * i);
  const BodyColumns people(person_m);
  const Eigen::Vector3d lamp_m(0, 1, 3);
  EXPECT_TRUE(people.hides(lamp_m, {3.5, 1.0, 0})) << "the ray passes at 1.3 m";
  EXPECT_FALSE(people.hides(lamp_m, {6.5, 1.0, 0})) << "over the head";
  EXPECT_FALSE(people.hides(lamp_m, {1.0, 1.0, 0})) << "before the person";
  EXPECT_FALSE(people.hides(lamp_m, {3.5, 3.0, 0})) << "beside the person";
  EXPECT_TRUE(people.hides({2.0, 1.0, 3}, {2.1, 1.1, 0})) << "below the feet";
  EXPECT_FALSE(people.hides(lamp_m, {3.5, 1.0, 1.6})) << "a place that is as high as the head";
}

TEST(BodyColumns, OfNobodyHideNothing) {
  EXPECT_FALSE(BodyColumns({}).hides({0, 0, 3}, {2, 0, 0}));
}

}  // namespace
}  // namespace mixrig::lights
