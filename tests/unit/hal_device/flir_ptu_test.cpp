// SPDX-License-Identifier: Apache-2.0
// The driver of the ASCII protocol against the emulated unit: special cases and faults.
#include "hal/wire/pan_tilt/flir_ptu.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "hal/fake/flir_ptu_emulator.h"
#include "hal/wire/pan_tilt/flir_ptu_baud.h"

namespace mixrig::device {
namespace {

using namespace std::chrono_literals;
constexpr double kStepRad = 185.1428 / 3600 / 180 * std::numbers::pi;

class FlirPtuTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto line = std::make_unique<fake::FlirPtuLine>(unit_, clock_);
    line_ = line.get();
    auto opened = FlirPtu::open(std::move(line), clock_, "flir-ptu:emulated");
    ASSERT_TRUE(opened) << to_line(opened.error());
    head_ = *std::move(opened);
  }
  long pan_steps(const PanTiltSample& sample) {
    return std::lround(sample.angles.pan_rad / kStepRad);
  }

  ManualClock clock_;
  fake::FlirPtuEmulator unit_{7};
  fake::FlirPtuLine* line_ = nullptr;
  std::unique_ptr<FlirPtu> head_;
};

TEST_F(FlirPtuTest, ReadsResolutionAndRangeFromTheUnit) {
  EXPECT_NEAR(head_->info().resolution.pan_rad, kStepRad, 1e-12);
  EXPECT_NEAR(head_->info().maximum.pan_rad, 3090 * kStepRad, 1e-9);
  EXPECT_NEAR(head_->info().minimum.tilt_rad, -907 * kStepRad, 1e-9);
  EXPECT_NE(head_->info().version.find("v2.14"), std::string::npos);
  EXPECT_EQ(head_->health().noise_bytes, 0U) << "echo is not noise";
}

TEST_F(FlirPtuTest, OpensBehindHalfACommandOfAnUnpluggedCable) {
  const std::array<std::uint8_t, 4> half{'P', 'P', '4', '6'};
  unit_.receive(half, clock_.now());
  const auto opened = FlirPtu::open(std::make_unique<fake::FlirPtuLine>(unit_, clock_), clock_,
                                    "flir-ptu:emulated");
  ASSERT_TRUE(opened) << to_line(opened.error());
  clock_.advance(5s);
  EXPECT_EQ(unit_.position(clock_.now())[0], 0) << "half a command moves nothing";
}

TEST_F(FlirPtuTest, TheEmulatedUnitStandsStillForACallerWhoseTimeIsEarlier) {
  ASSERT_TRUE(head_->move_to({10 * kStepRad, 0}));
  clock_.advance(5s);
  const HostTime now = clock_.now();
  EXPECT_EQ(unit_.position(now)[0], 10);
  EXPECT_EQ(unit_.position(now - 3ms)[0], 10);
  EXPECT_EQ(unit_.position(now)[0], 10);
}

TEST_F(FlirPtuTest, MinusOneIsAPositionLikeAnyOther) {
  ASSERT_TRUE(head_->move_to({-kStepRad, -kStepRad}));
  ASSERT_TRUE(await_position(*head_, {-kStepRad, -kStepRad}, clock_, 1s));
  EXPECT_EQ(pan_steps(*head_->sample()), -1);
}

TEST_F(FlirPtuTest, BothEndsOfTheRangeCanBeReached) {
  EXPECT_TRUE(head_->move_to({head_->info().maximum.pan_rad, head_->info().minimum.tilt_rad}));
}

TEST_F(FlirPtuTest, TenThousandCommandsAreAnsweredCorrectlyWithLimitReportsInsideReplies) {
  unit_.faults.limit_report_share = 0.2;
  std::mt19937_64 random(3);
  std::uniform_int_distribution<long> pan(-3090, 3090), tilt(-907, 604);
  line_->longest_read = 3;
  const std::uint64_t before = unit_.commands();
  long widest = 0;
  while (unit_.commands() - before < 10000) {
    const PanTiltAngles target{static_cast<double>(pan(random)) * kStepRad,
                               static_cast<double>(tilt(random)) * kStepRad};
    ASSERT_TRUE(head_->move_to(target));
    clock_.advance(3ms * (random() % 3000));
    // The reply gives a position that the axis passed between question and answer.
    const auto at_question = unit_.position(clock_.now());
    const auto sample = head_->sample();
    ASSERT_TRUE(sample) << to_line(sample.error());
    const auto at_answer = unit_.position(clock_.now());
    const double steps[] = {sample->angles.pan_rad / kStepRad, sample->angles.tilt_rad / kStepRad};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto [low, high] = std::minmax(at_question[axis], at_answer[axis]);
      EXPECT_GE(steps[axis], static_cast<double>(low) - 1.01);
      EXPECT_LE(steps[axis], static_cast<double>(high) + 1.01);
      widest = std::max(widest, high - low);
    }
    clock_.advance(10s);
    const auto arrived = head_->sample();
    ASSERT_TRUE(arrived);
    ASSERT_EQ(pan_steps(*arrived), std::lround(target.pan_rad / kStepRad));
    ASSERT_EQ(std::lround(arrived->angles.tilt_rad / kStepRad),
              std::lround(target.tilt_rad / kStepRad));
  }
  EXPECT_GT(widest, 10) << "the axes turned while they were asked";
  EXPECT_GT(unit_.limit_reports(), 1800U);
  EXPECT_TRUE(head_->health().limit_hit);
  unit_.faults.limit_report_share = 0;
  ASSERT_TRUE(head_->halt());  // reads what arrived after the last reply
  EXPECT_EQ(head_->health().limit_hits, unit_.limit_reports());
}

// The emulated line takes 1042 us a byte, 9600 baud.
TEST_F(FlirPtuTest, AStampIsTheTimeAtWhichTheUnitReadItsAxis) {
  struct Case {
    Duration byte_time;
    double most_ms;
  };
  // If the given byte time is shorter than the line's, a stamp is late by part of the answer.
  for (const Case& c : {Case{1042us, 0.01}, Case{2084us, 0.01}, Case{521us, 8}, Case{0us, 16}}) {
    fake::FlirPtuEmulator unit;
    ManualClock clock;
    const auto head = FlirPtu::open(std::make_unique<fake::FlirPtuLine>(unit, clock), clock,
                                    "flir-ptu:x", c.byte_time);
    ASSERT_TRUE(head);
    const HostTime asked = clock.now();
    const auto sample = (*head)->sample();
    ASSERT_TRUE(sample);
    const auto late_ms = [](HostTime stamp, HostTime truth) {
      return std::chrono::duration<double, std::milli>(stamp - truth).count();
    };
    const HostTime pan_read = asked + 3 * 1042us;
    const auto answer =
        static_cast<long>(std::string_view("* Current Pan position is 0\r\n").size());
    const HostTime tilt_read = pan_read + (answer + 3) * 1042us;
    EXPECT_NEAR(late_ms(sample->pan_at, pan_read), 0, c.most_ms);
    EXPECT_GE(late_ms(sample->pan_at, pan_read), c.most_ms * 0.8 - 0.02);
    EXPECT_NEAR(late_ms(sample->tilt_at, tilt_read), 0, c.most_ms + 1.1);
  }
}

TEST_F(FlirPtuTest, LimitFlagBelongsToTheLastMove) {
  unit_.faults.limit_report_share = 1;
  ASSERT_TRUE(head_->halt());
  EXPECT_TRUE(head_->health().limit_hit);
  unit_.faults.limit_report_share = 0;
  ASSERT_TRUE(head_->move_to({0.1, 0}));
  EXPECT_FALSE(head_->health().limit_hit);
}

TEST_F(FlirPtuTest, NoiseBetweenRepliesIsCountedAndSkipped) {
  unit_.faults.noise_share = 1;
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(head_->move_to({i * kStepRad, 0}));
    clock_.advance(1s);
    const auto sample = head_->sample();
    ASSERT_TRUE(sample) << to_line(sample.error());
    ASSERT_EQ(pan_steps(*sample), i);
  }
  EXPECT_GT(head_->health().noise_bytes, 300U);
}

TEST_F(FlirPtuTest, NoAnswerIsATimeoutAndRecoveryTakesLessThanTwoSeconds) {
  unit_.faults.silent = true;
  const auto silent = head_->sample();
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().code, ErrorCode::kTimeout);
  EXPECT_NE(silent.error().context.find("does not answer"), std::string::npos);
  EXPECT_GE(head_->health().timeouts, 1U);
  unit_.faults.silent = false;
  const HostTime back = clock_.now();
  ASSERT_TRUE(head_->sample());
  EXPECT_LT(clock_.now() - back, 2s);
}

TEST_F(FlirPtuTest, ALateAnswerIsNotTakenAsTheNextOne) {
  ASSERT_TRUE(head_->move_to({100 * kStepRad, 50 * kStepRad}));
  clock_.advance(2s);
  for (int late = 1; late <= 3; ++late) {
    unit_.faults.late_replies = late;
    const auto sample = head_->sample();
    ASSERT_TRUE(sample) << to_line(sample.error());
    EXPECT_EQ(pan_steps(*sample), 100);
    EXPECT_EQ(std::lround(sample->angles.tilt_rad / kStepRad), 50);
  }
}

TEST_F(FlirPtuTest, StalledHeadIsReportedWithItsDistance) {
  unit_.faults.stalled = true;
  ASSERT_TRUE(head_->move_to({0.5, 0}));
  const auto waited = await_position(*head_, {0.5, 0}, clock_, 3s);
  ASSERT_FALSE(waited);
  EXPECT_EQ(waited.error().code, ErrorCode::kTimeout);
  EXPECT_NE(waited.error().context.find("-0.5000 rad (pan)"), std::string::npos);
}

TEST_F(FlirPtuTest, RefusedCommandReportsTheUnitsText) {
  // The unit's own limit is narrower than the range check of the driver.
  const auto refused = head_->set_motion({.speed_rad_s = 200000 * kStepRad});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().context.find("Illegal argument"), std::string::npos);
  EXPECT_EQ(head_->health().refused, 1U);
}

TEST(FlirPtuOpen, NothingOnTheLineIsATimeout) {
  ManualClock clock;
  fake::FlirPtuEmulator unit;
  unit.faults.silent = true;
  const auto opened =
      FlirPtu::open(std::make_unique<fake::FlirPtuLine>(unit, clock), clock, "flir-ptu:x");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kTimeout);
}

struct ReplyCase {
  const char* bytes;
  bool ok;
  bool interrupted;
  const char* text;
};

// Measures for each line rate the positions of both axes per second, and the error of an angle at
// its stamp while the head turns. Only the line takes time here; a real unit also computes.
TEST(FlirPtuRate, PositionsComeAsOftenAsTheLineAllowsAndTheirStampsStayRight) {
  struct Case {
    int baud;
    double least_hz;
  };
  for (const Case& c : {Case{9600, 14}, Case{19200, 28}, Case{38400, 56}, Case{115200, 168}}) {
    ManualClock clock;
    fake::FlirPtuEmulator unit{3};
    auto line = std::make_unique<fake::FlirPtuLine>(unit, clock);
    line->baud = c.baud;
    auto head = FlirPtu::open(std::move(line), clock, "flir-ptu:emulated",
                              std::chrono::nanoseconds(10'000'000'000 / c.baud));
    ASSERT_TRUE(head) << to_line(head.error());
    constexpr double kSpeed_rad_s = 30.0 / 180 * std::numbers::pi;
    ASSERT_TRUE((*head)->set_motion({.speed_rad_s = kSpeed_rad_s, .acceleration_rad_s2 = 20}));
    ASSERT_TRUE((*head)->move_to({2.5, 0}));
    clock.advance(1s);  // it turns at full speed by now
    const HostTime begin = clock.now();
    int count = 0;
    double worst_rad = 0;
    std::optional<PanTiltSample> before;
    for (; clock.now() < begin + 1s; ++count) {
      const auto sample = (*head)->sample();
      ASSERT_TRUE(sample);
      // At constant speed a difference of stamps is a difference of angles, to within two steps.
      if (before)
        worst_rad =
            std::max(worst_rad, std::abs(sample->angles.pan_rad - before->angles.pan_rad -
                                         kSpeed_rad_s * seconds(sample->pan_at - before->pan_at)));
      before = *sample;
    }
    const double rate_hz = count / seconds(clock.now() - begin);
    std::printf("  measured: %6d baud: %.1f positions a second, steps of pan right to %.3f deg\n",
                c.baud, rate_hz, worst_rad * 180 / std::numbers::pi);
    EXPECT_GE(rate_hz, c.least_hz) << c.baud;
    EXPECT_LT(worst_rad, 2 * kStepRad) << c.baud;
  }
}

TEST(FlirPtuRate, OfTheUnitIsFoundWithoutMovingIt) {
  for (const int unit_baud : {9600, 19200, 38400, 57600, 115200}) {
    ManualClock clock;
    fake::FlirPtuEmulator unit{5};
    fake::FlirPtuLine line(unit, clock);
    line.unit_baud = unit_baud;
    const HostTime begin = clock.now();
    const auto found = find_ptu_baud(line, clock);
    ASSERT_TRUE(found) << unit_baud << ": " << to_line(found.error());
    EXPECT_EQ(*found, unit_baud);
    EXPECT_EQ(line.baud, unit_baud);
    EXPECT_LT(clock.now() - begin, 4s);
    EXPECT_EQ(unit.position(clock.now() + 5s)[0], 0);
  }
  ManualClock clock;
  fake::FlirPtuEmulator unit{5};
  fake::FlirPtuLine line(unit, clock);
  line.unit_baud = 4800;
  EXPECT_FALSE(find_ptu_baud(line, clock));
}

TEST(PtuReplyParser, SeparatesEchoLimitReportsAndReplies) {
  const ReplyCase cases[] = {
      {"*\r\n", true, false, ""},
      {"* 12\r\n", true, false, "12"},
      {"PP * -1\r\n", true, false, "-1"},
      {"! Illegal argument\r\n", false, false, "Illegal argument"},
      {"!P* 5\r\n", true, false, "5"},
      {"!T!T!P!P*\r\n", true, false, ""},
      {"* 1!P2\r\n", true, true, "12"},
      {"*!T 7\r\n", true, true, "7"},
      {"! Illegal!P argument\r\n", false, true, "Illegal argument"},
      {"xyz* 3\r\n", true, false, "3"},
  };
  for (const auto& c : cases) {
    PtuReplyParser parser;
    parser.expect("PP ");
    std::optional<PtuReply> reply;
    for (const char* at = c.bytes; *at != 0 && !reply; ++at) reply = parser.feed(*at);
    ASSERT_TRUE(reply) << c.bytes;
    EXPECT_EQ(reply->ok, c.ok) << c.bytes;
    EXPECT_EQ(reply->interrupted, c.interrupted) << c.bytes;
    EXPECT_EQ(reply->view(), c.text) << c.bytes;
  }
}

TEST(PtuNumber, ReadsExactlyOneValidNumberOrNone) {
  EXPECT_EQ(ptu_number("Current Pan position is -12"), -12.0);
  EXPECT_EQ(ptu_number("185.1428 seconds arc per Pan position"), 185.1428);
  EXPECT_EQ(ptu_number("+7"), 7.0);
  EXPECT_EQ(ptu_number("0"), 0.0);
  for (const char* bad : {"", "Pan", "1 2", "1x", "x1", "-", "1-2", "1.2.3", "+-1", "1e5"})
    EXPECT_FALSE(ptu_number(bad)) << bad;
}

TEST(PtuReplyParser, AcceptsAnyBytes) {
  std::mt19937_64 random(11);
  PtuReplyParser parser;
  std::size_t replies = 0;
  for (int i = 0; i < 1000000; ++i) {
    if (const auto reply = parser.feed(static_cast<char>(random() & 0xFF))) {
      ++replies;
      ASSERT_LE(reply->size, reply->text.size());
      (void)ptu_number(reply->view());
    }
  }
  EXPECT_GT(replies, 0U);
}

}  // namespace
}  // namespace mixrig::device
