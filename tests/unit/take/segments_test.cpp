// SPDX-License-Identifier: Apache-2.0
// Takes that follow each other in a folder are read as one.
#include "host/capture/take/segments/segments.h"

#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "host/capture/take/repair.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {
namespace fs = std::filesystem;

class SegmentFolder : public ::testing::Test {
 protected:
  /// Writes the frames first to last into the next segment; `earlier_s` is taken from their times.
  fs::path write(int first, int last, double earlier_s = 0, bool is_cut = false,
                 const TakeInfo& info = made_info()) {
    const auto path = next_segment(all_);
    EXPECT_TRUE(path) << to_line(path.error());
    auto writer = TakeWriter::create(*path, info, StreamFormat::kPng);
    EXPECT_TRUE(writer) << to_line(writer.error());
    for (int number = first; number <= last; ++number) {
      capture::Capture frame = made_frame(number);
      frame.time_s -= earlier_s;
      EXPECT_TRUE(writer->write(frame));
    }
    if (is_cut) return *path;
    EXPECT_TRUE(writer->finish());
    return *path;
  }
  /// Frames that all have the pixels of made_frame(); -1 where the folder does not open.
  int whole_frames() const {
    auto reader = TakeReader::open(all_);
    if (!reader) ADD_FAILURE() << to_line(reader.error());
    if (!reader) return -1;
    capture::Capture frame;
    for (int number = reader->info().frames; number >= 1; --number) {
      const auto read = reader->read(number, frame);
      EXPECT_TRUE(read) << to_line(read.error());
      EXPECT_EQ(frame.number, number);
      EXPECT_EQ(frame.plate.at(7, 9), made_frame(number).plate.at(7, 9)) << number;
      times_s_[number] = frame.time_s;
      EXPECT_NEAR(seconds(frame.mid_exposure.time_since_epoch()), frame.time_s, 1e-8);
    }
    return reader->info().frames;
  }
  test::TemporaryFolder folder_;
  fs::path all_ = folder_ / "day";
  mutable std::map<int, double> times_s_;
};

TEST_F(SegmentFolder, IsOneTakeWhoseTimesGoOn) {
  write(1, 3), write(4, 4), write(5, 7);
  EXPECT_TRUE(fs::exists(all_ / "0002/take.toml"));
  EXPECT_EQ(whole_frames(), 7);
  for (const auto& [number, time_s] : times_s_)
    EXPECT_NEAR(time_s, made_frame(number).time_s, 1e-6) << number;
  auto reader = TakeReader::open(all_);
  EXPECT_EQ(reader->info().segments, 3);
  EXPECT_EQ(reader->info().color.count, 7);
  EXPECT_TRUE(reader->info().moves);
  capture::Capture frame;
  EXPECT_TRUE(test::refused(reader->read(8, frame), {"has no frame 8"}, ErrorCode::kNotFound));
}

TEST_F(SegmentFolder, WhereTheClockBeganAgainTimesGoOnASecondLater) {
  write(1, 3), write(4, 6, made_frame(4).time_s);
  EXPECT_EQ(whole_frames(), 6);
  EXPECT_NEAR(times_s_[4] - times_s_[3], 1, 1e-6);
  EXPECT_NEAR(times_s_[6] - times_s_[4], 2 / 30.0, 1e-6);
}

TEST_F(SegmentFolder, ASegmentThatWasCutOffIsReadAndTheNextOneGoesOn) {
  write(1, 2), write(3, 5, 0, true);
  EXPECT_EQ(whole_frames(), 5);
  EXPECT_EQ(write(6, 7).filename(), "0003");
  EXPECT_EQ(whole_frames(), 7);
  ASSERT_TRUE(repair(all_ / "0002.partial"));
  EXPECT_EQ(whole_frames(), 7);
  fs::create_directory(all_ / "0004.partial");  // cut off before its first frame
  EXPECT_EQ(whole_frames(), 7);
}

TEST_F(SegmentFolder, ARecordingOfCompositesInSegmentsIsRepaired) {
  write(1, 2), write(3, 5, 0, true);
  fs::create_directory(folder_ / "shot.partial");
  fs::rename(all_, folder_ / "shot.partial/composite");
  const auto made = repair(folder_ / "shot.partial");
  ASSERT_TRUE(made) << to_line(made.error());
  EXPECT_EQ(made->take, folder_ / "shot/composite");
  EXPECT_NE(made->what.find("took 3 frames"), std::string::npos) << made->what;
  EXPECT_TRUE(fs::exists(folder_ / "shot/composite/0002/take.toml"));
  all_ = made->take;
  EXPECT_EQ(whole_frames(), 5);
}

TEST_F(SegmentFolder, SegmentsOfOtherCamerasAreRefused) {
  write(1, 2);
  TakeInfo other = made_info();
  other.target.pinhole.fx_px += 1;
  write(3, 4, 0, false, other);
  EXPECT_TRUE(
      test::refused(TakeReader::open(all_), {"0002", "0001", "other cameras"}, ErrorCode::kData));
}

TEST_F(SegmentFolder, AFolderOfPhotosNamedByAYearIsNoSegment) {
  fs::create_directories(all_ / "2024");
  std::ofstream(all_ / "2024/photo.jpg") << "photo";
  EXPECT_TRUE(segments_of(all_).empty());
  EXPECT_TRUE(test::refused(next_segment(all_), {"holds other things"}, ErrorCode::kUsage));
}

TEST_F(SegmentFolder, TheNextNumberFollowsTheLargest) {
  fs::create_directories(all_ / "0007");
  EXPECT_EQ(*next_segment(all_), all_ / "0008");
  fs::create_directories(all_ / "9999.partial");
  EXPECT_EQ(*next_segment(all_), all_ / "10000");
  fs::create_directories(all_ / "10000");
  EXPECT_EQ(segments_of(all_).back().number, 10000) << "by number, not by name";
  for (const char* name : {"take.toml", "letter.txt"}) {
    folder_.write(std::string("other") + name + "/" + name, "dear");
    EXPECT_TRUE(test::refused(next_segment(folder_ / (std::string("other") + name)),
                              {"holds other things"}, ErrorCode::kUsage));
  }
}

}  // namespace
}  // namespace mixrig::take
