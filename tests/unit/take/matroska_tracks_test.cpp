// SPDX-License-Identifier: Apache-2.0
// What a Matroska file holds, found out before a decoder is started: the begins of files that
// ffmpeg and GStreamer wrote.
#include "host/capture/take/streams/matroska_tracks.h"

#include <cstdlib>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

std::filesystem::path begin_of(const std::string& name) {
  const char* source = std::getenv("MIXRIG_SOURCE");
  return std::filesystem::path(source != nullptr ? source : ".") / "tests/data/matroska" /
         (name + ".mkv");
}

Result<void> check(const std::string& name, PixelKind kind) {
  return check_tracks(begin_of(name), kind);
}

TEST(MatroskaTracks, TheFormatOfFfv1IsReadFromItsRecordOrItsFirstFrame) {
  const std::map<std::string, std::string> formats{
      {"grey_8_version_0", "grey of 8 bits"},
      {"grey_10_version_1", "grey of 10 bits"},
      {"grey_12_version_1", "grey of 12 bits"},
      {"grey_12_version_3", "grey of 12 bits"},
      {"grey_16_version_3", "grey of 16 bits"},
      {"yuv420_version_0", "YUV 4:2:0 of 8 bits"},
      {"yuv422_10_version_3", "YUV 4:2:2 of 10 bits"},
      {"rgb_8_version_1", "RGB of 8 bits"},
      {"rgb_transparent_version_3", "RGB with transparency of 8 bits"}};
  for (const auto& [name, text] : formats) {
    const std::string bytes = test::read_bytes(begin_of(name));
    const auto tracks =
        parse_tracks({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    ASSERT_TRUE(tracks && tracks->size() == 1) << name;
    ASSERT_TRUE(tracks->front().ffv1) << name;
    EXPECT_EQ(text_of(*tracks->front().ffv1), text) << name;
  }
}

TEST(MatroskaTracks, WhatIsNotReadIsRefusedByWhatItIs) {
  using enum PixelKind;
  struct HeldRow {
    const char* name;
    PixelKind kind;
    std::initializer_list<std::string_view> words;
  };
  for (const HeldRow& row : {
           HeldRow{"grey_12_version_1", kGray16, {"holds FFV1 in grey of 12 bits", "gray16le"}},
           HeldRow{"grey_10_version_1", kGray16, {"grey of 10 bits, not in grey of 16 bits"}},
           HeldRow{"grey_12_version_3", kGray16, {"grey of 12 bits"}},
           HeldRow{"grey_8_version_0", kGray16, {"grey of 8 bits"}},
           HeldRow{"rgb_8_version_1", kGray16, {"RGB of 8 bits, not in grey of 16 bits"}},
           HeldRow{"yuv420_version_0", kRgb8, {"YUV 4:2:0", "-c:v ffv1 -pix_fmt bgr0"}},
           HeldRow{"yuv422_10_version_3", kRgb8, {"YUV 4:2:2 of 10 bits"}},
           HeldRow{"rgb_transparent_version_3", kRgb8, {"RGB with transparency"}},
           HeldRow{"grey_16_version_3", kRgb8, {"grey of 16 bits, not in RGB of 8 bits"}},
           HeldRow{
               "h264", kRgb8, {"h264.mkv' holds H.264, not FFV1", "ffmpeg -i h264.mkv -c:v ffv1"}},
           HeldRow{"mjpeg", kRgb8, {"holds MJPEG, not FFV1"}},
           HeldRow{"two_streams",
                   kRgb8,
                   {"holds 2 streams of pictures (MJPEG, raw pictures)", "mixrig import",
                    "-map 0:v:0"}},
           HeldRow{"sound", kRgb8, {"holds no pictures"}},
       })
    EXPECT_TRUE(test::refused(check(row.name, row.kind), row.words, ErrorCode::kFormat))
        << row.name;
}

TEST(MatroskaTracks, WhatIsReadPasses) {
  EXPECT_TRUE(check("rgb_8_version_1", PixelKind::kRgb8));
  EXPECT_TRUE(check("grey_16_version_3", PixelKind::kGray16));
}

TEST(MatroskaTracks, TakesOfThisProgramPass) {
  const test::TemporaryFolder folder;
  auto writer = TakeWriter::create(folder / "take", made_info(), StreamFormat::kMatroska);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write(made_frame(1)));
  ASSERT_TRUE(writer->finish());
  EXPECT_TRUE(check_tracks(folder / "take/color.mkv", PixelKind::kRgb8));
  EXPECT_TRUE(check_tracks(folder / "take/depth.mkv", PixelKind::kGray16));
  EXPECT_TRUE(test::refused(check_tracks(folder / "take/depth.mkv", PixelKind::kRgb8),
                            {"grey of 16 bits"}));
}

TEST(MatroskaTracks, AnyBytesEndInAnAnswer) {
  const std::string whole = test::read_bytes(begin_of("grey_12_version_3"));
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole.substr(0, random() % whole.size());
    for (int flips = 0; flips < 4 && !bytes.empty(); ++flips)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    (void)parse_tracks({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }
}

}  // namespace
}  // namespace mixrig::take
