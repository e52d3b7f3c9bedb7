// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/capture_reader.h"

#include <condition_variable>
#include <mutex>

#include <gtest/gtest.h>

#include "tests/support/progress.h"
#include "tests/support/refusal.h"

namespace mixrig::capture {
namespace {

/// Frame k has a plate with red = k. A live source counts the reads that have ended.
class NumberedSource final : public CaptureSource {
 public:
  explicit NumberedSource(int frames) { info_.frames = frames; }
  const SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    if (number == fails_at) return Error{ErrorCode::kData, "depth/000005.png: truncated"};
    if (number == throws_at) throw std::bad_alloc();
    if (number > last) return false;
    capture.number = number;
    capture.plate.reset({8, 6}, {static_cast<std::uint8_t>(number), 0, 0});
    ++reads;
    return true;
  }
  Result<void> read_truth(int number, Truth& truth) override {
    truth.matte.reset({8, 6}, static_cast<std::uint8_t>(number));
    return {};
  }
  int fails_at = 0, throws_at = 0, last = 1000;
  std::atomic<int> reads = 0;

 private:
  SourceInfo info_;
};

TEST(CaptureReader, GivesEveryFrameOfARecordingInOrderWithItsTruth) {
  NumberedSource source(100);
  CaptureReader reader(source, 11, 100, true);
  for (int number = 11; number <= 100; ++number) {
    const auto item = reader.next();
    ASSERT_TRUE(item);
    ASSERT_TRUE(*item) << number;
    EXPECT_EQ((*item)->capture->number, number);
    EXPECT_EQ((*item)->capture->plate.at(3, 3).r, number);
    EXPECT_EQ((*item)->truth->matte.at(1, 1), number);
  }
  EXPECT_FALSE(*reader.next()) << "after the last frame";
  EXPECT_FALSE(*reader.next()) << "also in later calls";
  EXPECT_EQ(reader.dropped(), 0U);
}

TEST(CaptureReader, ACaptureThatIsHeldIsNotOverwritten) {
  NumberedSource source(100);
  CaptureReader reader(source, 1, 100, false);
  const auto held = reader.next();
  for (int i = 2; i <= 60; ++i) (void)reader.next();
  EXPECT_EQ((**held).capture->plate.at(0, 0).r, 1);
}

TEST(CaptureReader, ErrorsComeInOrder) {
  NumberedSource source(100);
  source.fails_at = 3;
  CaptureReader reader(source, 1, 100, false);
  EXPECT_TRUE(reader.next());
  EXPECT_TRUE(reader.next());
  EXPECT_TRUE(test::refused(reader.next(), {}, ErrorCode::kData));
  EXPECT_FALSE(*reader.next());
}

TEST(CaptureReader, WhatASourceThrowsIsItsError) {
  NumberedSource source(100);
  source.throws_at = 2;
  CaptureReader reader(source, 1, 100, false);
  EXPECT_TRUE(reader.next());
  EXPECT_TRUE(test::refused(reader.next(), {"no memory is left"}, ErrorCode::kIo));
  EXPECT_FALSE(*reader.next());
}

TEST(CaptureReader, EndsWhereTheSourceEnds) {
  NumberedSource source(100);
  source.last = 4;
  CaptureReader reader(source, 1, 100, false);
  for (int i = 1; i <= 4; ++i) EXPECT_TRUE(*reader.next());
  EXPECT_FALSE(*reader.next());
}

TEST(CaptureReader, ALiveSourceNeverWaitsAndDropsTheOldest) {
  NumberedSource source(kEndless);
  source.last = 20;
  CaptureReader reader(source, 1, kEndless, false);
  ASSERT_TRUE(test::comes_true([&] { return source.reads == 20; }));
  std::vector<int> numbers;
  for (;;) {
    const auto item = reader.next();
    ASSERT_TRUE(item);
    if (!*item) break;
    numbers.push_back((**item).capture->number);
  }
  EXPECT_EQ(numbers, (std::vector<int>{19, 20})) << "the newest are kept";
  EXPECT_EQ(reader.dropped(), 18U);
}

TEST(CaptureReader, ReadsNothingWhileItsGateIsPaused) {
  NumberedSource source(100);
  WorkGate gate;
  CaptureReader reader(source, 1, 100, false, &gate);
  for (int number = 1; number <= 20; ++number) {
    EXPECT_EQ((*reader.next())->capture->number, number);
    const WorkGate::Pause pause(&gate);
    const int reads = source.reads;
    // The last one was taken: without the gate the next one would be read now.
    for (int i = 0; i < 200; ++i) std::this_thread::yield();
    ASSERT_EQ(source.reads, reads);
  }
}

TEST(CaptureReader, CanBeDroppedWhileItWaits) {
  NumberedSource source(100);
  { CaptureReader reader(source, 1, 100, false); }
  EXPECT_LE(source.reads, 100);
}

}  // namespace
}  // namespace mixrig::capture
