// SPDX-License-Identifier: Apache-2.0
// OpenEXR files: exact round trips, and damaged files.
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::image_io {
namespace {

std::vector<Channel> depth_and_sigma() {
  std::vector<Channel> channels{{"Z", Image<float>(Size{19, 7})},
                                {"sigma", Image<float>(Size{19, 7})}};
  std::mt19937 random(3);
  for (Channel& channel : channels)
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 19; ++x) channel.pixels.at(x, y) = static_cast<float>(random()) * 1e-7F;
  channels[0].pixels.at(0, 0) = std::numeric_limits<float>::quiet_NaN();
  channels[0].pixels.at(1, 0) = -1.5F;
  channels[0].pixels.at(2, 0) = std::numeric_limits<float>::denorm_min();
  return channels;
}

TEST(Exr, ChannelsComeBackBitForBit) {
  const test::TemporaryFolder folder;
  const auto written = depth_and_sigma();
  ASSERT_TRUE(write_exr(folder / "a.exr", written));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.exr.partial"));
  const auto read = read_exr(folder / "a.exr");
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_EQ(read->size(), written.size());
  for (std::size_t c = 0; c < written.size(); ++c) {
    EXPECT_EQ((*read)[c].name, written[c].name);
    ASSERT_EQ((*read)[c].pixels.size(), written[c].pixels.size());
    for (int y = 0; y < 7; ++y)
      EXPECT_EQ(std::memcmp((*read)[c].pixels.row(y), written[c].pixels.row(y), 19 * sizeof(float)),
                0);
  }
}

TEST(Exr, EveryTruncationIsRefused) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_exr(folder / "a.exr", depth_and_sigma()));
  const std::string whole = test::read_bytes(folder / "a.exr");
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    const auto result = read_exr(folder.write("cut.exr", whole.substr(0, length)));
    ASSERT_FALSE(result) << length;
    EXPECT_EQ(result.error().code, ErrorCode::kFormat);
  }
}

TEST(Exr, AChannelNameThatSpansLinesLeavesTheErrorOneLine) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_exr(folder / "a.exr", {{"depth", Image<float>({4, 3}, 1.0F)}}));
  std::string bytes = test::read_bytes(folder / "a.exr");
  const std::size_t at = bytes.find("depth");
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, 5, "de\n\x1b["), bytes[at + 6] = 9;  // a channel of a type that there is not
  const auto read = read_exr(folder.write("b.exr", bytes));
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().context.find("de??["), std::string::npos) << read.error().context;
  for (const char c : read.error().context) EXPECT_GE(c, ' ') << read.error().context;
}

TEST(Exr, ChangedBytesNeverCrash) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_exr(folder / "a.exr", depth_and_sigma()));
  const std::string whole = test::read_bytes(folder / "a.exr");
  std::mt19937 random(4);
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    for (int flips = 0; flips < 3; ++flips)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto result = read_exr(folder.write("changed.exr", bytes));
    if (result && !result->empty()) {
      EXPECT_FALSE(result->front().pixels.empty());
    }
  }
}

TEST(Exr, ChannelsOfTwoSizesAndMissingFilesAreErrors) {
  const test::TemporaryFolder folder;
  const std::vector<Channel> unequal{{"a", Image<float>(Size{2, 2})},
                                     {"b", Image<float>(Size{3, 2})}};
  EXPECT_EQ(write_exr(folder / "a.exr", unequal).error().code, ErrorCode::kData);
  EXPECT_EQ(read_exr(folder / "none.exr").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mixrig::image_io
