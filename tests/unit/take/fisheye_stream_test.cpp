// SPDX-License-Identifier: Apache-2.0
// The fisheye stream of a take comes back at its own rate, and a broken one is refused or reported.
#include "host/capture/take/streams/fisheye_stream.h"

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

using capture::Stream;
using capture::StreamStatus;
namespace fs = std::filesystem;

constexpr Size kFisheyeSize{19, 14};
constexpr int kTakeFrames = 10, kEvery = 3;  // fresh in frames 1, 4, 7, 10; the plate at 30 Hz

Image<Rgb8> made_fisheye(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  Image<Rgb8> picture(kFisheyeSize);
  for (const auto [x, y] : test::each_pixel(kFisheyeSize))
    picture.at(x, y) = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                        static_cast<std::uint8_t>(random())};
  return picture;
}

HostTime fisheye_time(int number) {
  return HostTime(std::chrono::nanoseconds(33'333'333LL * (number - 1) + 4'321'987));
}

capture::Capture frame_with_fisheye(int number) {
  capture::Capture frame = made_frame(number);
  frame.set_status(Stream::kFisheye, StreamStatus::kRepeated);
  if ((number - 1) % kEvery != 0) return frame;
  frame.set_status(Stream::kFisheye, StreamStatus::kFresh);
  frame.fisheye = made_fisheye(number);
  frame.fisheye_mid_exposure = fisheye_time(number);
  frame.fisheye_counter = 700U + static_cast<unsigned>(number);
  return frame;
}

class FisheyeTake : public ::testing::TestWithParam<StreamFormat> {
 protected:
  void SetUp() override {
    TakeInfo info = made_info();
    info.fisheye.emplace().rate_hz = 10;
    auto writer = TakeWriter::create(take_, info, GetParam());
    ASSERT_TRUE(writer) << writer.error().context;
    for (int number = 1; number <= kTakeFrames; ++number)
      ASSERT_TRUE(writer->write(frame_with_fisheye(number)));
    ASSERT_TRUE(writer->finish());
  }
  void replace_in(const char* file, const std::string& from, const std::string& to) {
    std::stringstream text;
    text << std::ifstream(take_ / file).rdbuf();
    std::string words = text.str();
    const auto at = words.find(from);
    ASSERT_NE(at, std::string::npos) << words;
    words.replace(at, from.size(), to);
    std::ofstream(take_ / file) << words;
  }
  fs::path picture_file() const {
    return take_ / (GetParam() == StreamFormat::kPng ? "fisheye/000002.png" : "fisheye.mkv");
  }
  StreamStatus status_of(TakeReader& reader, int number) {
    const auto read = reader.read(number, frame_);
    EXPECT_TRUE(read) << read.error().context;
    return frame_.status_of(Stream::kFisheye);
  }

  const test::TemporaryFolder folder_;
  const fs::path take_ = folder_ / "take";
  capture::Capture frame_;
};

TEST_P(FisheyeTake, PicturesStampsAndCountersComeBackInAnyOrder) {
  auto reader = TakeReader::open(take_);
  ASSERT_TRUE(reader) << reader.error().context;
  ASSERT_TRUE(reader->info().fisheye);
  EXPECT_EQ(reader->info().fisheye->count, 4);
  EXPECT_EQ(reader->info().fisheye->rate_hz, 10);
  for (const int number : {1, 2, 3, 4, 10, 5, 2, 9, 8, 7}) {
    const int fresh = number - (number - 1) % kEvery;
    EXPECT_EQ(status_of(*reader, number),
              fresh == number ? StreamStatus::kFresh : StreamStatus::kRepeated);
    EXPECT_EQ(frame_.fisheye_mid_exposure, fisheye_time(fresh));
    EXPECT_EQ(frame_.fisheye_counter, 700U + static_cast<unsigned>(fresh));
    ASSERT_EQ(frame_.fisheye.size(), kFisheyeSize);
    const Image<Rgb8> written = made_fisheye(fresh);
    for (const auto [x, y] : test::each_pixel(kFisheyeSize))
      ASSERT_EQ(frame_.fisheye.at(x, y), written.at(x, y)) << number;
  }
}

TEST_P(FisheyeTake, AShorterStreamEndsInMissingPictures) {
  replace_in("fisheye.csv", "4,10,", "4,12,");
  replace_in("take.toml", "count = 4", "count = 2");
  auto reader = TakeReader::open(take_);
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(status_of(*reader, 4), StreamStatus::kFresh);
  EXPECT_EQ(status_of(*reader, 8), StreamStatus::kRepeated);  // 129 ms
  EXPECT_EQ(status_of(*reader, 9), StreamStatus::kMissing);   // 162 ms
  EXPECT_TRUE(frame_.fisheye.empty());
  EXPECT_EQ(frame_.fisheye_mid_exposure, HostTime{});
  EXPECT_EQ(frame_.fisheye_counter, 0U);
}

TEST_P(FisheyeTake, AMissingTableAndADamagedPictureAreErrorsOfOneLine) {
  fs::resize_file(picture_file(), fs::file_size(picture_file()) / 2);
  if (auto reader = TakeReader::open(take_); reader) {
    Result<void> read;
    for (int number = 1; number <= kTakeFrames && read; ++number)
      read = reader->read(number, frame_);
    EXPECT_TRUE(test::refused(read, {"fisheye"}));
  }
  fs::remove(take_ / "fisheye.csv");
  EXPECT_TRUE(test::refused(TakeReader::open(take_), {"fisheye.csv"}));
}

TEST_P(FisheyeTake, APictureThatIsNotLaterThanTheLastIsLeftOut) {
  auto writer = TakeWriter::create(folder_ / "back", made_info(), GetParam());
  ASSERT_TRUE(writer);
  for (const int number : {4, 1, 7}) ASSERT_TRUE(writer->write(frame_with_fisheye(number)));
  ASSERT_TRUE(writer->finish());
  auto reader = TakeReader::open(folder_ / "back");
  ASSERT_TRUE(reader) << reader.error().context;
  EXPECT_EQ(reader->info().fisheye->count, 2);
  EXPECT_EQ(status_of(*reader, 3), StreamStatus::kFresh);
  EXPECT_EQ(frame_.fisheye_counter, 707U);
}

INSTANTIATE_TEST_SUITE_P(Formats, FisheyeTake,
                         ::testing::Values(StreamFormat::kPng, StreamFormat::kMatroska));

TEST(FisheyeTable, TakesOnlyRowsThatGrow) {
  const std::string head = "picture,frame,counter,mid_exposure_ns\n";
  const auto good = parse_fisheye_table(head + "1,2,8,50\n2,5,9,60\n", "f");
  ASSERT_TRUE(good) << good.error().context;
  EXPECT_EQ(good->back().frame, 5);
  EXPECT_TRUE(parse_fisheye_table(head, "f")->empty());
  for (const char* bad : {"2,2,8,50\n", "1,0,8,50\n", "1,2,8\n", "1,2,-8,50\n", "1,2,8,nan\n",
                          "1,2,8,50\n2,2,9,60\n", "1,2,8,50\n2,3,9,50\n", "1,2,8,50,1\n"}) {
    EXPECT_TRUE(test::refused(parse_fisheye_table(head + bad, "f"), {}, ErrorCode::kFormat)) << bad;
  }
}

}  // namespace
}  // namespace mixrig::take
