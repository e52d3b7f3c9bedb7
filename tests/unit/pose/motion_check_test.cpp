// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/motion_check.h"

#include <gtest/gtest.h>

#include "tests/unit/pose/swing.h"

namespace mixrig::pose {
namespace {

using Verdict = MotionCheck::Verdict;

TEST(MotionCheck, TakesAMovingCamera) {
  MotionCheck check;
  for (const auto& sample : swing_samples(0, 4, 25)) EXPECT_EQ(check.add(sample), Verdict::kTake);
  EXPECT_EQ(check.faults().jumps, 0U);
}

TEST(MotionCheck, LeavesOutWrongSamplesAndCountsEachPlaceOnce) {
  auto samples = swing_samples(0, 2, 120);
  samples[50].world_from_body.translation_m.x() += 1;   // one sample
  samples[100].world_from_body.translation_m.y() -= 2;  // two that belong together
  samples[101].world_from_body.translation_m.y() -= 2;
  samples[150].world_from_body.translation_m.z() = NAN;
  samples[160].world_from_body.rotation.coeffs() *= 0.5;
  MotionCheck check;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool wrong = i == 50 || i == 100 || i == 101 || i == 150 || i == 160;
    EXPECT_EQ(check.add(samples[i]), wrong ? Verdict::kRejected : Verdict::kTake) << i;
  }
  EXPECT_EQ(check.faults().jumps, 2U);
  EXPECT_EQ(check.faults().not_finite, 2U);
  EXPECT_EQ(check.faults().clock_steps, 0U);
}

TEST(MotionCheck, GoesOnWhereTheCameraIsAfterAJump) {
  auto samples = swing_samples(0, 2, 120);
  for (std::size_t i = 100; i < samples.size(); ++i)
    samples[i].world_from_body.translation_m.x() += 1;
  MotionCheck check;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Verdict verdict = check.add(samples[i]);
    if (i == 100 || i == 101) {
      EXPECT_EQ(verdict, Verdict::kRejected);
    }
    if (i > 102) {
      EXPECT_EQ(verdict, Verdict::kTake);
    }
    if (i != 102) continue;
    ASSERT_EQ(verdict, Verdict::kRestart);
    ASSERT_EQ(check.run().size(), MotionCheck::kRun);
    for (std::size_t k = 0; k < MotionCheck::kRun; ++k)
      EXPECT_EQ(check.run()[k].t_s, samples[100 + k].t_s);
  }
  EXPECT_EQ(check.faults().jumps, 1U);
}

TEST(MotionCheck, AWrongFirstSampleIsLeftBehind) {
  auto samples = swing_samples(0, 1, 120);
  samples[0].world_from_body.translation_m.x() += 3;
  MotionCheck check;
  std::size_t restart = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (check.add(samples[i]) == Verdict::kRestart) restart = i;
  EXPECT_EQ(restart, 3U);
}

TEST(MotionCheck, CountsAClockThatStepsBack) {
  MotionCheck check;
  for (const auto& sample : swing_samples(0, 1, 120)) check.add(sample);
  Verdict last = Verdict::kTake;
  for (auto sample : swing_samples(1, 2, 120)) {
    sample.t_s -= 100;
    last = check.add(sample);
  }
  EXPECT_EQ(last, Verdict::kTake) << "it goes on on the new clock";
  EXPECT_EQ(check.faults().clock_steps, 1U);
  EXPECT_EQ(check.faults().jumps, 0U);
}

}  // namespace
}  // namespace mixrig::pose
