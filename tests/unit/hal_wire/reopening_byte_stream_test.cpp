// SPDX-License-Identifier: Apache-2.0
// A cable that is unplugged and plugged in again, below the pan-tilt unit's driver.
#include "hal/wire/reopening_byte_stream.h"

#include <gtest/gtest.h>

#include "hal/fake/flir_ptu_emulator.h"
#include "hal/wire/pan_tilt/flir_ptu.h"

namespace mixrig::device {
namespace {

using namespace std::chrono_literals;

/// A cable to an emulated unit, unplugged and plugged in by the test.
class Cable : public ::testing::Test {
 protected:
  Result<std::unique_ptr<ByteStream>> plug() {
    ++opened_;
    if (!plugged_) return Error{ErrorCode::kNotFound, "no serial port"};
    auto line = std::make_unique<fake::FlirPtuLine>(unit_, clock_);
    line_ = line.get();
    return std::unique_ptr<ByteStream>(std::move(line));
  }
  void pull() {
    plugged_ = false;
    line_->unplugged = true;
  }
  Result<std::unique_ptr<ByteStream>> make() {
    return ReopeningByteStream::make([this] { return plug(); }, clock_);
  }
  ManualClock clock_;
  fake::FlirPtuEmulator unit_{5};
  fake::FlirPtuLine* line_ = nullptr;
  bool plugged_ = true;
  int opened_ = 0;
};

TEST_F(Cable, AStreamThatCannotBeOpenedAtFirstIsAnError) {
  plugged_ = false;
  const auto stream = make();
  ASSERT_FALSE(stream);
  EXPECT_EQ(stream.error().code, ErrorCode::kNotFound);
}

TEST_F(Cable, IsTriedAtMostFourTimesASecond) {
  auto stream = make();
  ASSERT_TRUE(stream);
  pull();
  std::uint8_t byte = 0;
  for (int i = 0; i < 1000; ++i, clock_.advance(1ms)) {
    const auto count = (*stream)->read({&byte, 1}, 0ms);
    ASSERT_FALSE(count);
    EXPECT_EQ(count.error().code, ErrorCode::kDevice);
  }
  EXPECT_LE(opened_, 5);
  EXPECT_GE(opened_, 4);
}

TEST_F(Cable, ThePanTiltUnitAnswersAgainWithinTwoSecondsOfItsReturn) {
  auto stream = make();
  ASSERT_TRUE(stream);
  auto head = FlirPtu::open(*std::move(stream), clock_, "flir-ptu:cable");
  ASSERT_TRUE(head) << to_line(head.error());
  pull();
  for (int i = 0; i < 20; ++i, clock_.advance(200ms)) {
    const auto sample = (*head)->sample();
    ASSERT_FALSE(sample);
    EXPECT_EQ(sample.error().code, ErrorCode::kDevice);
  }
  EXPECT_EQ((*head)->health().returns, 0U);
  // The unit lost power too: it echoes again, as after a reset.
  unit_ = fake::FlirPtuEmulator(6);
  plugged_ = true;
  const HostTime back = clock_.now();
  while (!(*head)->sample() && clock_.now() - back < 10s) clock_.advance(200ms);
  EXPECT_LT(clock_.now() - back, 2s);
  EXPECT_EQ((*head)->health().returns, 1U);
  EXPECT_TRUE((*head)->move_to({0.1, 0}));
}

}  // namespace
}  // namespace mixrig::device
