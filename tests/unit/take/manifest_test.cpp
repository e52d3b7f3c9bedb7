// SPDX-License-Identifier: Apache-2.0
// take.toml: the errors that are found, and their messages.
#include "host/capture/take/manifest.h"

#include <random>

#include <gtest/gtest.h>

#include "host/capture/take/streams/picture_files.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

const char* const kGood = R"(format = 1
[color]
path = "c/%06d.png"
count = 3
[depth]
path = "d/%d.png"
count = 3
[target]
size_px = [640, 480]
fx = 500.0
fy = 500.0
cx = 319.5
cy = 239.5
distortion = [0.01, 0.0, 0.0, 0.0]
[tof]
size_px = [320, 240]
fx = 300
fy = 300
cx = 160
cy = 120
[target_from_tof]
rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
translation_m = [0.1, 0.0, 0.0]
)";

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  const auto manifest = parse_manifest(text, "t/take.toml");
  return manifest ? "" : manifest.error().context;
}

TEST(Manifest, RawDepthIsDistancesInNumberedFiles) {
  const std::string raw = "path = \"raw/%06d.bin\"\nraw = \"kinect2\"";
  const auto manifest =
      parse_manifest(replaced("path = \"d/%d.png\"", raw + "\nkind = \"distance\""), "t/take.toml");
  ASSERT_TRUE(manifest) << manifest.error().context;
  EXPECT_EQ(manifest->info.raw_depth, "kinect2");
  EXPECT_TRUE(manifest->info.amplitude_is_light);
  EXPECT_NE(error_of(replaced("path = \"d/%d.png\"", raw)).find("\"distance\""), std::string::npos);
  EXPECT_NE(error_of(replaced("path = \"d/%d.png\"", "path = \"d/%d.png\"\nraw = \"sr3000\""))
                .find("kinect2"),
            std::string::npos);
}

TEST(Manifest, DefaultsAndValuesOfAShortFile) {
  const auto manifest = parse_manifest(kGood, "t/take.toml");
  ASSERT_TRUE(manifest) << manifest.error().context;
  const TakeInfo& info = manifest->info;
  EXPECT_EQ(info.root, "t/");
  EXPECT_EQ(info.color, (StreamInfo{"c/%06d.png", 1, 3, 0}));
  EXPECT_EQ(info.exposure_s, 0) << "not known";
  EXPECT_EQ(info.depth_unit_m, 0.001);
  EXPECT_EQ(info.depth_kind, capture::DepthKind::kZ);
  EXPECT_EQ(info.target.lens.coefficients()[0], 0.01);
  EXPECT_EQ(info.tof.pinhole.fx_px, 300.0);
  EXPECT_EQ(info.target_from_tof.translation_m, Eigen::Vector3d(0.1, 0, 0));
  EXPECT_FALSE(info.has_poses);
  EXPECT_FALSE(info.has_truth);
}

TEST(Manifest, TellsHowLongAPlateIsExposed) {
  const auto read = parse_manifest(
      replaced("count = 3\n[depth]", "count = 3\nexposure_ms = 8.0\n[depth]"), "t/take.toml");
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_DOUBLE_EQ(read->info.exposure_s, 0.008);
  const auto again = parse_manifest(manifest_text(read->info), "t/take.toml");
  ASSERT_TRUE(again) << again.error().context;
  EXPECT_DOUBLE_EQ(again->info.exposure_s, 0.008);
}

TEST(Manifest, ReportsEachWrongValueWithLineAndKey) {
  struct Row {
    const char *from, *to, *says;
  };
  const Row rows[] = {
      {"format = 1", "format = 2", "t/take.toml:1: key \"format\": 2 is out of range: give 1 to 1"},
      {"count = 3\n[depth]", "[depth]", "key \"color.count\": missing"},
      {"count = 3\n[depth]", "count = 0\n[depth]",
       "t/take.toml:4: key \"color.count\": 0 is out of range"},
      {"count = 3\n[target]", "coutn = 3\n[target]",
       "t/take.toml:7: key \"depth.coutn\": not known: did you mean \"count\"?"},
      {"c/%06d.png", "c/%s.png",
       "t/take.toml:3: key \"color.path\": \"c/%s.png\" needs exactly one number"},
      {"c/%06d.png", "c/%d%d.png", "needs exactly one number"},
      {"c/%06d.png", "c.mkv", "key \"color.rate_hz\": missing"},
      {"count = 3\n[depth]", "count = 3\nexposure_ms = -1\n[depth]",
       "t/take.toml:5: key \"color.exposure_ms\": -1 is out of range"},
      {"c/%06d.png", "c.txt", "lists (.txt) must name both"},
      {"size_px = [640, 480]", "size_px = [640, 0]",
       "t/take.toml:9: key \"target.size_px\": 0 is out of range"},
      {"fx = 500.0", "fx = 0.0", "t/take.toml:10: key \"target.fx\": 0 is out of range"},
      {"fx = 500.0", "fx = nan", "t/take.toml:10: key \"target.fx\": nan is out of range"},
      {"distortion = [0.01,", "distortion = [-9.0,", "key \"target.fx\": "},
      {"distortion = [0.01, 0.0,", "distortion = [0.01,", "must be an array of 4 to 8 numbers"},
      {"[[1.0, 0.0, 0.0]", "[[2.0, 0.0, 0.0]",
       "t/take.toml:22: key \"target_from_tof.rotation\": "},
      {"[[1.0, 0.0, 0.0]", "[[-1.0, 0.0, 0.0]", "key \"target_from_tof.rotation\": "},
      {"[[1.0, 0.0, 0.0]", "[[0.0, 0.0, 0.0]", "key \"target_from_tof.rotation\": "},
      {"[[1.0, 0.0, 0.0]", "[[nan, 0.0, 0.0]", "key \"target_from_tof.rotation\": "},
      {"[[1.0, 0.0, 0.0], ", "[", "must be 3 arrays of 3 numbers"},
      {"[tof]", "[pose]\n[tof]", "give either file or world_from_target"},
      {"[tof]", "[toff]", "key \"toff\": not known: did you mean \"tof\"?"},
  };
  for (const Row& row : rows) {
    const std::string error = error_of(replaced(row.from, row.to));
    EXPECT_NE(error.find(row.says), std::string::npos) << row.to << "\n  " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(Manifest, AnUnsetVariableInRootIsNamed) {
  unsetenv("MIXRIG_NO_SUCH_FOLDER");
  const std::string error =
      error_of("root = \"${MIXRIG_NO_SUCH_FOLDER}/x\"\n" + std::string(kGood));
  EXPECT_NE(
      error.find(
          "t/take.toml:1: key \"root\": environment variable MIXRIG_NO_SUCH_FOLDER is not set"),
      std::string::npos)
      << error;
}

TEST(Manifest, WhatIsWrittenIsReadBack) {
  TakeInfo info = made_info();
  info.color = {"color/%06d.png", 1, 7, 30.0};
  info.depth = {"depth.mkv", 1, 7, 29.97};
  info.depth_kind = capture::DepthKind::kDistance;
  info.depth_unit_m = 1.0 / 3000.0;
  info.depth_offset_m = -0.0125;
  info.has_truth = true;
  const std::vector<int> further{65535, 1200};
  const auto read = parse_manifest(manifest_text(info, false, further), "t/take.toml");
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(read->further_unknown, further);
  EXPECT_EQ(read->info.name, info.name);
  EXPECT_EQ(read->info.color, info.color);
  EXPECT_EQ(read->info.depth, info.depth);
  EXPECT_EQ(read->info.depth_kind, info.depth_kind);
  EXPECT_EQ(read->info.depth_unit_m, info.depth_unit_m);
  EXPECT_EQ(read->info.depth_offset_m, info.depth_offset_m);
  EXPECT_EQ(read->info.target.lens.coefficients(), info.target.lens.coefficients());
  EXPECT_EQ(read->info.target.pinhole, info.target.pinhole);
  EXPECT_EQ(read->info.tof.pinhole, info.tof.pinhole);
  EXPECT_EQ(read->info.view, info.view);
  EXPECT_EQ(read->info.target_from_tof.translation_m, info.target_from_tof.translation_m);
  EXPECT_EQ(read->info.noise.quadratic_per_m, info.noise.quadratic_per_m);
  EXPECT_EQ(read->pose_file, "poses.txt");
  EXPECT_EQ(read->truth_path, "truth");
}

TEST(Manifest, TextOfAnyKindIsReadBack) {
  TakeInfo info = made_info();
  info.color.path = info.depth.path = "%d.png";
  info.color.count = info.depth.count = 1;
  for (const char* name :
       {"\"quoted\"", "back\\slash", "two\nlines", "B\xc3\xbchne \xe5\xae\xa4", "a = 1"}) {
    info.name = name;
    const auto read = parse_manifest(manifest_text(info), "t/take.toml");
    ASSERT_TRUE(read) << read.error().context;
    EXPECT_EQ(read->info.name, name);
  }
}

TEST(Manifest, CamerasMayBeTheTablesOfCalibrationToml) {
  const auto manifest =
      parse_manifest(replaced("rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]",
                              "rotation_xyzw = [0.0, 0.0, 1.0, 0.0]\nresidual_px = 0.2\nviews = 9"),
                     "t/take.toml");
  ASSERT_TRUE(manifest) << manifest.error().context;
  EXPECT_EQ(manifest->info.target_from_tof.rotation.z(), 1.0);
  EXPECT_NE(error_of(replaced("[tof]", "[tof]\nmodel = \"fisheye\"\ndistortion = [0, 0, 0, 0]"))
                .find("key \"tof.model\""),
            std::string::npos);
}

TEST(Manifest, AnyBytesEndInAManifestOrOneLine) {
  std::mt19937 random(6);
  const std::string whole = kGood;
  for (int i = 0; i < 2000; ++i) {
    std::string text = whole.substr(0, i % 3 == 0 ? random() % whole.size() : whole.size());
    for (unsigned flips = random() % 4; flips > 0 && !text.empty(); --flips)
      text[random() % text.size()] = static_cast<char>(32 + random() % 95);
    EXPECT_EQ(error_of(text).find('\n'), std::string::npos);
  }
}

TEST(NumberedName, WritesTheNumberAsThePatternSays) {
  EXPECT_EQ(NumberedName::parse("a/%06d.png")->with(42), "a/000042.png");
  EXPECT_EQ(NumberedName::parse("a%d")->with(42), "a42");
  EXPECT_EQ(NumberedName::parse("%03d.jpg")->with(12345), "12345.jpg");
  for (const char* bad : {"a.png", "%", "%5d", "%0d", "%00d", "%n", "%d%d", "%%d", "%06"})
    EXPECT_FALSE(NumberedName::parse(bad)) << bad;
}

}  // namespace
}  // namespace mixrig::take
