// SPDX-License-Identifier: Apache-2.0
// A take or a folder of views that is stopped while it is rendered leaves nothing.
#include <atomic>

#include <gtest/gtest.h>

#include "studio/io/board_set.h"
#include "studio/io/board_source.h"
#include "studio/io/studio_take.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::studio_io {
namespace {

class StoppedStudio : public ::testing::Test {
 protected:
  void expect_stopped(const Result<void>& done) {
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, ErrorCode::kData);
    EXPECT_EQ(done.error().context, "stopped after 1 of 3 pictures: nothing was written");
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  }
  template <typename Made>
  static Result<void> outcome(const Result<Made>& made) {
    return made ? Result<void>() : made.error();
  }
  test::TemporaryFolder folder_;
  std::atomic<bool> stop_ = false;
  const std::function<void(int)> stop_at_once_ = [this](int) { stop_ = true; };
};

TEST_F(StoppedStudio, LeavesNoTake) {
  studio::StudioOptions options;
  options.frames = 3, options.size_px = {64, 52};
  expect_stopped(outcome(write_studio_take(options, folder_.path() / "take",
                                           take::StreamFormat::kPng, stop_at_once_, &stop_)));
}

TEST_F(StoppedStudio, LeavesNoViewsOfABoard) {
  studio::BoardOptions options;
  options.views = 3, options.size_px = {64, 64};
  expect_stopped(
      outcome(write_board_set(options, folder_.path() / "views", stop_at_once_, &stop_)));
}

TEST_F(StoppedStudio, LeavesNoTakeOfABoard) {
  studio::BoardOptions options;
  options.size_px = {64, 64}, options.fisheye_px = {64, 64};
  expect_stopped(outcome(write_board_take(options, 3, folder_.path() / "take",
                                          take::StreamFormat::kPng, stop_at_once_, &stop_)));
}

TEST_F(StoppedStudio, ATakeThatIsDoneIsWritten) {
  studio::StudioOptions options;
  options.frames = 2, options.size_px = {64, 52};
  const auto stop_at_last = [this](int done) { stop_ = done == 2; };
  EXPECT_TRUE(write_studio_take(options, folder_.path() / "take", take::StreamFormat::kPng,
                                stop_at_last, &stop_));
}

}  // namespace
}  // namespace mixrig::studio_io
