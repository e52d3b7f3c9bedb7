// SPDX-License-Identifier: Apache-2.0
#include "hal/base/half.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

/// Value of a half-precision number by the definition of binary16.
double value_of(int half) {
  const int exponent = half >> 10, mantissa = half & 0x3FF;
  return exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
}

TEST(Half, EveryFiniteValueIsItself) {
  for (int half = 0; half < 0x7C00; ++half) {
    const auto bits = static_cast<std::uint16_t>(half);
    ASSERT_EQ(float_of_half(bits), value_of(half)) << half;
    ASSERT_EQ(half_of_float(float_of_half(bits)), half);
  }
}

TEST(Half, BetweenTwoTheNearerOne) {
  for (int half = 0; half < 0x7BFF; ++half) {
    const double low = value_of(half), high = value_of(half + 1);
    ASSERT_EQ(half_of_float(static_cast<float>(0.51 * low + 0.49 * high)), half);
    ASSERT_EQ(half_of_float(static_cast<float>(0.49 * low + 0.51 * high)), half + 1);
  }
}

TEST(Half, WhatItDoesNotHoldIsClamped) {
  EXPECT_EQ(half_of_float(-1), 0);
  EXPECT_EQ(half_of_float(1e9F), 0x7BFF);
  EXPECT_EQ(half_of_float(std::numeric_limits<float>::infinity()), 0x7BFF);
  EXPECT_EQ(half_of_float(std::numeric_limits<float>::quiet_NaN()), 0x7BFF);
}

}  // namespace
}  // namespace mixrig
