// SPDX-License-Identifier: Apache-2.0
// A take that grows: whole after each append, continued after an interruption.
#include "host/capture/take/growing_take.h"

#include <array>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

GrowingTake opened(const std::filesystem::path& folder) {
  auto take = GrowingTake::open(folder, made_info());
  EXPECT_TRUE(take) << take.error().context;
  return *std::move(take);
}

void append(GrowingTake& take, int first, double pan_rad) {
  const std::array frames{made_frame(first), made_frame(first + 1)};
  const auto appended = take.append(frames, {pan_rad, -0.25});
  ASSERT_TRUE(appended) << appended.error().context;
}

/// Red of the first pixel, and the pan, of each frame.
std::vector<std::pair<int, double>> contents(const std::filesystem::path& folder) {
  auto reader = TakeReader::open(folder);
  EXPECT_TRUE(reader) << reader.error().context;
  std::vector<std::pair<int, double>> all;
  capture::Capture frame;
  for (int number = 1; reader && number <= reader->info().frames; ++number) {
    const auto read = reader->read(number, frame);
    EXPECT_TRUE(read) << read.error().context;
    EXPECT_FALSE(frame.amplitude.empty());
    all.emplace_back(frame.plate.at(0, 0).r, frame.pan_tilt ? frame.pan_tilt->pan_rad : -1);
  }
  return all;
}

std::pair<int, double> frame_of(int number, double pan_rad) {
  return {made_frame(number).plate.at(0, 0).r, pan_rad};
}

TEST(GrowingTake, IsATakeAfterEachAppend) {
  const test::TemporaryFolder folder;
  GrowingTake take = opened(folder / "sweep");
  EXPECT_EQ(take.frames(), 0);
  append(take, 1, 0.5);
  EXPECT_EQ(contents(folder / "sweep"), (std::vector{frame_of(1, 0.5), frame_of(2, 0.5)}));
  append(take, 3, 0.75);
  EXPECT_EQ(contents(folder / "sweep"), (std::vector{frame_of(1, 0.5), frame_of(2, 0.5),
                                                     frame_of(3, 0.75), frame_of(4, 0.75)}));
}

TEST(GrowingTake, WhatWasInterruptedIsNotInItAndIsWrittenAgain) {
  const test::TemporaryFolder folder;
  {
    GrowingTake take = opened(folder / "sweep");
    append(take, 1, 0.5);
  }
  // The writer ended between the table and the manifest.
  const std::string manifest = test::read_bytes(folder / "sweep/take.toml");
  {
    GrowingTake take = opened(folder / "sweep");
    append(take, 3, 0.75);
  }
  (void)folder.write("sweep/take.toml", manifest);
  EXPECT_EQ(contents(folder / "sweep").size(), 2U);
  GrowingTake take = opened(folder / "sweep");
  EXPECT_EQ(take.frames(), 2);
  append(take, 5, 1.5);
  EXPECT_EQ(contents(folder / "sweep"),
            (std::vector{frame_of(1, 0.5), frame_of(2, 0.5), frame_of(5, 1.5), frame_of(6, 1.5)}));
}

/// Frames 40 ms apart whose fisheye was exposed 5 ms before every second one, and shown again.
std::array<capture::Capture, 4> frames_with_fisheye(long begin_ms) {
  using std::chrono::milliseconds;
  std::array<capture::Capture, 4> frames;
  for (int i = 0; i < 4; ++i) {
    capture::Capture& frame = frames[static_cast<std::size_t>(i)];
    frame = made_frame(i + 1);
    frame.mid_exposure = HostTime(milliseconds(begin_ms + 40 * i));
    frame.set_status(capture::Stream::kFisheye,
                     i % 2 == 0 ? capture::StreamStatus::kFresh : capture::StreamStatus::kRepeated);
    frame.fisheye.reset({9, 7}, {static_cast<std::uint8_t>(begin_ms + i / 2), 0, 0});
    frame.fisheye_mid_exposure = HostTime(milliseconds(begin_ms + 80 * (i / 2) - 5));
    frame.fisheye_counter = 50U + static_cast<unsigned>(i / 2);
  }
  return frames;
}

TEST(GrowingTake, GrowsWithItsFisheyeAndGoesOnAfterAnInterruption) {
  using std::chrono::milliseconds;
  const test::TemporaryFolder folder;
  TakeInfo info = made_info();
  info.has_poses = false;
  info.fisheye.emplace().rate_hz = 12.5;
  {
    auto take = GrowingTake::open(folder / "sweep", info);
    ASSERT_TRUE(take);
    ASSERT_TRUE(take->append(frames_with_fisheye(1000), {0.5, 0}));
  }
  // The host was started again: its clock too.
  auto take = GrowingTake::open(folder / "sweep", info);
  ASSERT_TRUE(take) << take.error().context;
  EXPECT_EQ(take->frames(), 4);
  const auto later = frames_with_fisheye(7);
  ASSERT_TRUE(take->append(std::span(later).first(2), {0.75, 0}));
  ASSERT_TRUE(take->append(std::span(later).last(2), {0.75, 0}));
  auto reader = TakeReader::open(folder / "sweep");
  ASSERT_TRUE(reader) << reader.error().context;
  ASSERT_TRUE(reader->info().fisheye);
  EXPECT_EQ(reader->info().fisheye->count, 4);
  EXPECT_EQ(reader->info().fisheye->rate_hz, 12.5);
  capture::Capture frame;
  for (int number = 1; number <= 8; ++number) {
    SCOPED_TRACE(number);
    ASSERT_TRUE(reader->read(number, frame));
    EXPECT_EQ(frame.status_of(capture::Stream::kFisheye),
              number % 2 == 1 ? capture::StreamStatus::kFresh : capture::StreamStatus::kRepeated);
    const int picture = (number - 1) % 4 / 2, begin_ms = number <= 4 ? 1000 : 7;
    EXPECT_EQ(frame.fisheye.at(2, 3).r, (begin_ms + picture) & 255);
    EXPECT_EQ(frame.fisheye_counter, 50U + static_cast<unsigned>(picture));
    EXPECT_EQ(frame.mid_exposure - frame.fisheye_mid_exposure,
              number % 2 == 1 ? milliseconds(5) : milliseconds(45));
  }
  EXPECT_EQ(frame.mid_exposure, HostTime(milliseconds(1000 + 3 * 40 + 1000 + 3 * 40)));
}

TEST(GrowingTake, FramesThatCannotBeWrittenLeaveItAsItWas) {
  const test::TemporaryFolder folder;
  GrowingTake take = opened(folder / "sweep");
  append(take, 1, 0.5);
  std::array frames{made_frame(3), made_frame(4)};
  frames[1].amplitude.reset({});
  EXPECT_EQ(take.append(frames, {}).error().code, ErrorCode::kData);
  std::filesystem::remove_all(folder / "sweep/depth");
  EXPECT_EQ(take.append(std::array{made_frame(3)}, {}).error().code, ErrorCode::kIo);
  EXPECT_EQ(take.frames(), 2);
}

}  // namespace
}  // namespace mixrig::take
