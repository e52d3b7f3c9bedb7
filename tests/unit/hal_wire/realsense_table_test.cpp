// SPDX-License-Identifier: Apache-2.0
// Bytes as librealsense's structures lay them out; CRC-32 by zlib.
#include "hal/wire/camera/realsense_table.h"

#include <gtest/gtest.h>

#include "tests/support/realsense_answer.h"

namespace mixrig::test {
namespace {

TEST(RealSenseTable, GivesFocalLengthAndCentreOfTheSize) {
  const auto answer = realsense_answer(3, {421.5F, 422.0F, 423.25F, 241.75F});
  const auto k = device::parse_realsense_calibration(answer, {848, 480});
  ASSERT_TRUE(k) << to_line(k.error());
  EXPECT_EQ(k->focal_px, 421.5);
  EXPECT_EQ(k->principal_x_px, 423.25);
  EXPECT_EQ(k->principal_y_px, 241.75);
  const auto last = device::parse_realsense_calibration(
      realsense_answer(12, {600.0F, 600.0F, 320.0F, 200.0F}), {640, 400});
  ASSERT_TRUE(last);
  EXPECT_EQ(last->principal_y_px, 200.0);
}

TEST(RealSenseTable, WhatIsDamagedCutOffOrNotInItIsRefused) {
  const auto whole = realsense_answer(3, {421.5F, 421.5F, 423.25F, 241.75F});
  const auto refused = [](std::vector<std::uint8_t> answer, Size size, const char* why) {
    const auto k = device::parse_realsense_calibration(answer, size);
    ASSERT_FALSE(k) << why;
    EXPECT_NE(to_line(k.error()).find(why), std::string::npos) << to_line(k.error());
  };
  const auto with = [&](std::size_t at, int value) {
    auto changed = whole;
    changed[at] = static_cast<std::uint8_t>(value);
    return changed;
  };
  refused(with(20 + 240 + 3 * 16, 1), {848, 480}, "is damaged (CRC)");
  refused(with(0, 0xFF), {848, 480}, "was refused");
  refused(with(6, 31), {848, 480}, "is another one");
  refused(with(9, 0xFF), {848, 480}, "is cut off");
  refused(with(1021, 0xFF), {848, 480}, "a length that does not fit");
  refused({whole.begin(), whole.end() - 1}, {848, 480}, "is not 1024 bytes long");
  refused(whole, {640, 480}, "has no values for this size");
  refused(whole, {100, 100}, "has no pictures of 100x100");
  refused(whole, {0, 0}, "has no pictures of 0x0");
}

TEST(RealSenseTable, TheRequestIsThatOfTheHardwareMonitor) {
  const auto request = device::realsense_calibration_request();
  const std::uint8_t begin[] = {20, 0, 0xAB, 0xCD, 0x15, 0, 0, 0, 25, 0, 0, 0};
  EXPECT_TRUE(std::equal(std::begin(begin), std::end(begin), request.begin()));
  EXPECT_TRUE(std::all_of(request.begin() + 12, request.end(), [](int byte) { return byte == 0; }));
  EXPECT_TRUE(device::is_realsense_d400(0x8086, 0x0B07));
  EXPECT_FALSE(device::is_realsense_d400(0x8086, 0x0B64)) << "L515";
}

}  // namespace
}  // namespace mixrig::test
