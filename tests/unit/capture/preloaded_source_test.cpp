// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/preloaded_source.h"

#include <gtest/gtest.h>

#include "tests/support/refusal.h"

namespace mixrig::capture {
namespace {

/// Numbered pictures; counts what is read.
class Numbered final : public CaptureSource {
 public:
  Numbered(int frames, int& reads) : reads_(reads) { info_.frames = frames, info_.name = "made"; }
  void set_rate(double hz) { info_.rate_hz = hz; }
  const SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    ++reads_;
    if (number == 13) return Error{ErrorCode::kData, "unlucky"};
    capture.number = number;
    capture.time_s = 0.04 * number;
    capture.mid_exposure = HostTime(std::chrono::milliseconds(40 * number));
    capture.plate.reset({4, 3}, {static_cast<std::uint8_t>(number), 0, 0});
    return true;
  }
  Result<void> read_truth(int number, Truth& truth) override {
    truth.matte.reset({1, 1}, static_cast<std::uint8_t>(number));
    return {};
  }

 private:
  int& reads_;
  SourceInfo info_;
};

TEST(PreloadedSourceTest, GivesTheSameCapturesInAnyOrderAndReadsNothingAgain) {
  int reads = 0;
  auto source = preloaded(std::make_unique<Numbered>(5, reads));
  ASSERT_TRUE(source);
  EXPECT_EQ(reads, 5);
  Capture capture;
  for (const int number : {5, 1, 3, 3}) {
    ASSERT_TRUE(*(*source)->read(number, capture));
    EXPECT_EQ(capture.number, number);
    EXPECT_EQ(capture.plate.at(3, 2).r, number);
  }
  EXPECT_FALSE(*(*source)->read(0, capture));
  EXPECT_FALSE(*(*source)->read(6, capture));
  EXPECT_EQ(reads, 5);
  Truth truth;
  ASSERT_TRUE((*source)->read_truth(2, truth));
  EXPECT_EQ(truth.matte.at(0, 0), 2);
}

TEST(RepeatedSourceTest, GoesOnInTimeAfterTheLast) {
  int reads = 0;
  auto made = std::make_unique<Numbered>(5, reads);
  made->set_rate(25);
  const auto source = repeated(std::move(made), 12);
  EXPECT_EQ(source->info().frames, 12);
  Capture capture;
  for (const auto& [number, red] : {std::pair(5, 5), {6, 1}, {12, 2}}) {
    ASSERT_TRUE(*source->read(number, capture));
    EXPECT_EQ(capture.number, number);
    EXPECT_EQ(capture.plate.at(0, 0).r, red);
    EXPECT_NEAR(capture.time_s, 0.04 * number, 1e-12);
    EXPECT_EQ(capture.mid_exposure, HostTime(std::chrono::milliseconds(40 * number)));
  }
  EXPECT_FALSE(*source->read(13, capture));
  EXPECT_FALSE(*source->read(0, capture));
  Truth truth;
  EXPECT_FALSE(source->read_truth(1, truth));
}

TEST(PreloadedSourceTest, RefusesWhatHasNoEndOrCannotBeRead) {
  int reads = 0;
  EXPECT_TRUE(
      test::refused(preloaded(std::make_unique<Numbered>(kEndless, reads)), {}, ErrorCode::kUsage));
  EXPECT_EQ(reads, 0);
  const auto broken = preloaded(std::make_unique<Numbered>(20, reads));
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().context, "unlucky");
}

}  // namespace
}  // namespace mixrig::capture
