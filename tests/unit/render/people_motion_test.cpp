// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/people_motion.h"

#include <cmath>

#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kSampled{80, 60};

/// Texture of a surface, 0..255, smooth over a few samples.
float texture(float x, float y) {
  return 128 + 50 * std::sin(0.9F * x + 0.3F * y) + 40 * std::sin(0.7F * y - 0.4F * x);
}

/// A sparse picture of a still room; people are painted into it.
struct MotionScene {
  MotionScene() {
    samples.light.reset(
        {kSampled.width + 2 * render::kMotionReach, kSampled.height + 2 * render::kMotionReach});
    samples.w.reset(kSampled);
    for (int y = 0; y < samples.light.height(); ++y)
      for (int x = 0; x < samples.light.width(); ++x)
        samples.light.row(y)[x] = texture(static_cast<float>(3 * x), static_cast<float>(2 * y));
  }
  /// A person of 12 x 24 samples, whose texture moves along.
  void person(float x0, float y0, float z_m, float clothes) {
    for (int y = 0; y < kSampled.height; ++y)
      for (int x = 0; x < kSampled.width; ++x) {
        const float u = static_cast<float>(x) - x0, v = static_cast<float>(y) - y0;
        if (u < 0 || v < 0 || u >= 12 || v >= 24) continue;
        samples.w.row(y)[x] = 1 / z_m;
        samples.light.row(y + render::kMotionReach)[x + render::kMotionReach] =
            texture(u + clothes, v);
      }
  }
  render::PeopleSamples samples;
};

glm::vec2 at(const Image<glm::vec2>& motion, int x, int y) {
  return motion.at(x / render::kMotionCell, y / render::kMotionCell);
}

bool all_stand_still(const Image<glm::vec2>& motion) {
  for (int y = 0; y < motion.height(); ++y)
    for (int x = 0; x < motion.width(); ++x)
      if (motion.at(x, y) != glm::vec2(0)) return false;
  return true;
}

TEST(PeopleMotion, of_a_person_who_stands_still_is_none) {
  MotionScene before, now;
  before.person(30, 20, 3, 5), now.person(30, 20, 3, 5);
  for (int y = 0; y < now.samples.light.height(); ++y)
    for (int x = 0; x < now.samples.light.width(); ++x)
      now.samples.light.row(y)[x] += static_cast<float>((7 * x + 3 * y) % 5) - 2;  // noise
  render::ClusterMotion clusters(kSampled);
  const Image<glm::vec2>& motion = clusters.find(now.samples, before.samples);
  EXPECT_TRUE(all_stand_still(motion));
}

TEST(PeopleMotion, finds_a_shift_between_samples) {
  MotionScene before, now;
  before.person(30, 20, 3, 5), now.person(33.5F, 19, 3, 5);
  render::ClusterMotion clusters(kSampled);
  const Image<glm::vec2>& motion = clusters.find(now.samples, before.samples);
  EXPECT_NEAR(at(motion, 39, 30).x, 3.5F, 0.3F);
  EXPECT_NEAR(at(motion, 39, 30).y, -1, 0.3F);
  EXPECT_EQ(at(motion, 5, 30), glm::vec2(0)) << "far from people";
  EXPECT_TRUE(clusters.near_people(30 / render::kMotionCell - 1, 30 / render::kMotionCell));
  EXPECT_FALSE(clusters.near_people(1, 7));
}

TEST(PeopleMotion, of_two_who_cross_is_that_of_each) {
  MotionScene before, now;
  before.person(20, 20, 4, 5), before.person(40, 22, 2, 60);
  now.person(23, 20, 4, 5), now.person(36, 22, 2, 60);
  render::ClusterMotion clusters(kSampled);
  const Image<glm::vec2>& motion = clusters.find(now.samples, before.samples);
  EXPECT_NEAR(at(motion, 28, 30).x, 3, 0.4F);
  EXPECT_NEAR(at(motion, 42, 30).x, -4, 0.4F);
}

TEST(PeopleMotion, of_an_empty_room_and_of_one_who_left_is_none) {
  MotionScene before, now;
  before.person(30, 20, 3, 5);
  render::ClusterMotion clusters(kSampled);
  const Image<glm::vec2>& motion = clusters.find(now.samples, before.samples);
  EXPECT_TRUE(all_stand_still(motion));
}

/// Single wrong depths, and what is smaller than a person.
TEST(PeopleMotion, small_clusters_stand_still) {
  MotionScene before, now;
  before.person(30, 20, 3, 5), now.person(33, 20, 3, 5);
  for (int y = 0; y < kSampled.height; ++y)
    for (int x = 0; x < kSampled.width; ++x)
      if (y >= 28 || x >= 40) now.samples.w.row(y)[x] = 0;
  render::ClusterMotion clusters(kSampled);
  EXPECT_EQ(at(clusters.find(now.samples, before.samples), 36, 24), glm::vec2(0));
}

}  // namespace
}  // namespace mixrig::test
