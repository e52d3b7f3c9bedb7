// SPDX-License-Identifier: Apache-2.0
#include "hal/base/result.h"

#include <cerrno>
#include <memory>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

Result<int> half(int n) {
  if (n % 2 != 0) return Error{ErrorCode::kData, "odd"};
  return n / 2;
}

Result<int> quarter(int n) {
  MIXRIG_ASSIGN(const int h, half(n));
  return half(h);
}

Result<void> check(int n) {
  MIXRIG_TRY(n > 0 ? Result<void>() : Result<void>(Error{ErrorCode::kUsage, "not positive"}));
  return {};
}

TEST(Result, HoldsAValueOrAnError) {
  EXPECT_EQ(*half(8), 4);
  ASSERT_FALSE(half(3));
  EXPECT_EQ(half(3).error().code, ErrorCode::kData);
}

TEST(Result, AssignReturnsTheFirstError) {
  EXPECT_EQ(*quarter(8), 2);
  EXPECT_FALSE(quarter(6));
  EXPECT_FALSE(quarter(5));
}

TEST(Result, TryReturnsTheError) {
  EXPECT_TRUE(check(1));
  EXPECT_EQ(check(0).error().context, "not positive");
}

TEST(Result, CarriesMoveOnlyValues) {
  Result<std::unique_ptr<int>> r(std::make_unique<int>(7));
  const std::unique_ptr<int> out = *std::move(r);
  EXPECT_EQ(*out, 7);
}

TEST(Result, LineNamesTheSystemError) {
  EXPECT_EQ(to_line(system_error(ErrorCode::kIo, "open x", ENOENT)),
            "open x (No such file or directory)");
  EXPECT_EQ(to_line(Error{ErrorCode::kUsage, "plain"}), "plain");
}

}  // namespace
}  // namespace mixrig
