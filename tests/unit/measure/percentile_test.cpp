// SPDX-License-Identifier: Apache-2.0
#include "hal/base/percentile.h"

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

TEST(Quantile, InterpolatesBetweenRanks) {
  // numpy.percentile([4, 1, 3, 2], [0, 50, 95, 100]) = 1, 2.5, 3.85, 4
  const std::vector<float> samples{4, 1, 3, 2};
  EXPECT_DOUBLE_EQ(quantile(samples, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(quantile(samples, 0.5), 2.5);
  EXPECT_NEAR(quantile(samples, 0.95), 3.85, 1e-12);
  EXPECT_DOUBLE_EQ(quantile(samples, 1.0), 4.0);
}

TEST(Quantile, OfOneSampleIsThatSampleAndOfNoneIsZero) {
  EXPECT_DOUBLE_EQ(quantile({7.0F}, 0.95), 7.0);
  EXPECT_DOUBLE_EQ(quantile({}, 0.5), 0.0);
}

TEST(Mean, OfNothingIsZero) {
  EXPECT_DOUBLE_EQ(mean({}), 0.0);
  const std::vector<float> samples{1, 2, 6};
  EXPECT_DOUBLE_EQ(mean(samples), 3.0);
}

}  // namespace
}  // namespace mixrig::measure
