// SPDX-License-Identifier: Apache-2.0
// Takes whose writing was cut off: what is whole opens, the rest is left out, nothing is replaced.
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "host/capture/take/disk_sync.h"
#include "host/capture/take/growing_table.h"
#include "host/capture/take/repair.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/throw_in.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {
namespace fs = std::filesystem;

constexpr int kCutFrames = 5;

/// Files of this process cannot grow beyond a size, as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

/// Number of frames; -1 where the take does not open. Each frame has the pixels that were written.
int whole_frames(const fs::path& folder) {
  auto reader = TakeReader::open(folder);
  if (!reader) return -1;
  capture::Capture frame;
  for (int number = reader->info().frames; number >= 1; --number) {
    const auto read = reader->read(number, frame);
    if (!read) {
      ADD_FAILURE() << read.error().context;
      return -1;
    }
    const capture::Capture made = made_frame(number);
    EXPECT_EQ(frame.plate.at(7, 9), made.plate.at(7, 9)) << number;
    EXPECT_EQ(frame.amplitude.at(16, 11), made.amplitude.at(16, 11)) << number;
    EXPECT_EQ(frame.time_s, made.time_s) << number;
  }
  return reader->info().frames;
}

class CutTake : public ::testing::TestWithParam<StreamFormat> {
 protected:
  /// A writer that is dropped leaves what a process leaves that is killed, except frames that wait
  /// for the encoder.
  void SetUp() override {
    auto writer = TakeWriter::create(folder_ / "take", made_info(), GetParam());
    ASSERT_TRUE(writer);
    for (int number = 1; number <= kCutFrames; ++number)
      ASSERT_TRUE(writer->write(made_frame(number)));
    if (GetParam() == StreamFormat::kMatroska) return;  // its frames may wait for the encoder
    EXPECT_EQ(whole_frames(partial_), kCutFrames) << "while it is written";
  }
  test::TemporaryFolder folder_;
  fs::path partial_ = folder_ / "take.partial";
};

TEST_P(CutTake, TheNextRecordingOfTheNameSetsItAside) {
  for (int left = 0; left < 2; ++left) {
    auto writer = TakeWriter::create(folder_ / "take", made_info(), GetParam());
    ASSERT_TRUE(writer) << writer.error().context;
    for (int number = 1; number <= 2; ++number) ASSERT_TRUE(writer->write(made_frame(number)));
    if (left == 0) continue;  // cut off
    ASSERT_TRUE(writer->finish());
  }
  EXPECT_EQ(whole_frames(folder_ / "take.1.partial"), kCutFrames);
  EXPECT_EQ(whole_frames(folder_ / "take.2.partial"), 2);
  EXPECT_EQ(whole_frames(folder_ / "take"), 2);
  ASSERT_TRUE(repair(folder_ / "take.1.partial"));
  EXPECT_EQ(whole_frames(folder_ / "take.1"), kCutFrames);
}

TEST_P(CutTake, OpensAndIsMadeWhole) {
  EXPECT_EQ(whole_frames(partial_), kCutFrames);
  const auto made = repair(partial_);
  ASSERT_TRUE(made) << made.error().context;
  EXPECT_EQ(made->take, folder_ / "take");
  EXPECT_NE(made->what.find("took 5 frames, the last 0.0 s were cut off"), std::string::npos)
      << made->what;
  EXPECT_FALSE(fs::exists(partial_));
  EXPECT_EQ(whole_frames(folder_ / "take"), kCutFrames);
  EXPECT_EQ(test::read_bytes(folder_ / "take/take.toml").find("unfinished"), std::string::npos);
  EXPECT_TRUE(test::refused(repair(partial_), {"NAME.partial"}, ErrorCode::kUsage));
}

TEST_P(CutTake, ANameThatIsTakenIsNotReplaced) {
  folder_.write("take/letter.txt", "dear");
  EXPECT_TRUE(test::refused(repair(partial_), {"exists"}, ErrorCode::kUsage));
  EXPECT_EQ(test::read_bytes(folder_ / "take/letter.txt"), "dear");
  EXPECT_EQ(whole_frames(partial_), kCutFrames);
}

TEST_P(CutTake, ARowWithoutAnEndIsLeftOut) {
  const std::string poses = test::read_bytes(partial_ / "poses.txt");
  folder_.write("take.partial/poses.txt", poses.substr(0, poses.size() - 5));
  EXPECT_EQ(whole_frames(partial_), kCutFrames - 1);
  ASSERT_TRUE(repair(partial_));
  EXPECT_EQ(whole_frames(folder_ / "take"), kCutFrames - 1);
}

TEST_P(CutTake, ZerosOfAPowerCutAreLeftOut) {
  const std::string poses = test::read_bytes(partial_ / "poses.txt");
  folder_.write("take.partial/poses.txt", poses + std::string(4096, '\0'));
  EXPECT_EQ(whole_frames(partial_), kCutFrames);
  folder_.write("take.partial/poses.txt",
                poses.substr(0, poses.size() - 5) + std::string(4096, '\0') + "\n");
  EXPECT_EQ(whole_frames(partial_), kCutFrames - 1);
  ASSERT_TRUE(repair(partial_));
  EXPECT_EQ(whole_frames(folder_ / "take"), kCutFrames - 1);
  EXPECT_EQ(test::read_bytes(folder_ / "take/poses.txt").find('\0'), std::string::npos);
}

TEST_P(CutTake, WhatIsBeingWrittenIsNotRenamed) {
  auto writer = TakeWriter::create(folder_ / "other", made_info(), GetParam());
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write(made_frame(1)));
  EXPECT_TRUE(
      test::refused(repair(folder_ / "other.partial"), {"still being written"}, ErrorCode::kUsage));
  EXPECT_TRUE(test::refused(TakeWriter::create(folder_ / "other", made_info(), GetParam()),
                            {"other.partial", "by another program"}, ErrorCode::kUsage));
  EXPECT_TRUE(writer->finish());
}

INSTANTIATE_TEST_SUITE_P(Formats, CutTake,
                         ::testing::Values(StreamFormat::kPng, StreamFormat::kMatroska));

class CutMatroska : public CutTake {};

TEST_P(CutMatroska, EachLengthOfAStreamGivesTheFramesThatAreWhole) {
  const std::string whole = test::read_bytes(partial_ / "color.mkv");
  int before = -1;
  constexpr std::size_t kSteps = 60;
  for (std::size_t step = 0; step <= kSteps; ++step) {
    folder_.write("take.partial/color.mkv", whole.substr(0, whole.size() * step / kSteps));
    const int frames = whole_frames(partial_);
    EXPECT_GE(frames, before) << step;
    EXPECT_NE(frames, 0);
    before = frames;
  }
  EXPECT_EQ(before, kCutFrames);
}

INSTANTIATE_TEST_SUITE_P(Formats, CutMatroska, ::testing::Values(StreamFormat::kMatroska));

TEST(FullTake, AFullDiskIsNamedAndTheTakeEndsWholeBeforeIt) {
  for (const StreamFormat format : {StreamFormat::kMatroska, StreamFormat::kPng}) {
    const test::TemporaryFolder folder;
    auto writer = TakeWriter::create(folder / "take", made_info(), format);
    ASSERT_TRUE(writer);
    Result<void> written;
    {
      const FullDisk full(format == StreamFormat::kPng ? 2300 : 40000);
      for (int number = 1; written && number <= 3000; ++number)
        written = writer->write(made_frame(number));
    }
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().context.find("cannot write"), std::string::npos)
        << written.error().context;
    const auto finished = writer->finish();
    ASSERT_TRUE(finished) << finished.error().context;
    EXPECT_GE(whole_frames(folder / "take"), 5);
  }
}

TEST(FullTake, WhatTheThreadOfTheDiskThrowsIsNamed) {
  const test::TemporaryFolder folder;
  const test::ThrowIn thrown("writing to the disk");
  DiskSync disk(folder.path());
  EXPECT_TRUE(test::refused(disk.finish(), {"writing to the disk: no memory is left"}));
}

TEST(GrowingTable, HasAllRowsOfAnAppendOrNone) {
  const test::TemporaryFolder folder;
  GrowingTable table(folder / "rows.csv", "a,b\n");
  ASSERT_TRUE(table.append("1,2\n3,4\n"));
  const std::string before = test::read_bytes(folder / "rows.csv");
  EXPECT_EQ(before, "a,b\n1,2\n3,4\n");
  {
    const FullDisk full(before.size() + 3);
    EXPECT_TRUE(test::refused(table.append("5,6\n"), {"rows.csv", "free space"}, ErrorCode::kIo));
  }
  EXPECT_EQ(test::read_bytes(folder / "rows.csv"), before);
  ASSERT_TRUE(table.append("7,8\n"));
  EXPECT_EQ(test::read_bytes(folder / "rows.csv"), before + "7,8\n");
  EXPECT_EQ(whole_rows("a\nb"), "a\n");
  EXPECT_EQ(whole_rows("b"), "");
}

}  // namespace
}  // namespace mixrig::take
