// SPDX-License-Identifier: Apache-2.0
// Background folders: exact, whole or not at all, and damaged ones.
#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "host/room/background/static_background.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::model {
namespace {

StaticBackground made() {
  const Size size{7, 5};
  StaticBackground background;
  background.view = {size, 30.25, 30.5, 3.1, 2.1};
  background.frames = 12;
  background.depth_m.reset(size, 2.345678F);
  background.depth_m.at(6, 4) = 0.0F;
  background.depth_sigma_m.reset(size, 0.0123F);
  background.color.reset(size, {0.1F, 0.2F, 0.3F});
  background.color_sigma.reset(size, 0.004F);
  background.floor = geometry::Plane{Eigen::Vector3d(0.1, -0.9, 0.2).normalized(), 1.234567890123};
  return background;
}

TEST(BackgroundFile, ComesBackExactly) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(save(made(), folder / "b"));
  EXPECT_FALSE(std::filesystem::exists(folder / "b.partial"));
  const auto read = load_static_background(folder / "b");
  ASSERT_TRUE(read) << read.error().context;
  const StaticBackground written = made();
  EXPECT_EQ(read->view, written.view);
  EXPECT_EQ(read->frames, 12);
  EXPECT_EQ(read->depth_m.at(0, 0), written.depth_m.at(0, 0));
  EXPECT_EQ(read->depth_m.at(6, 4), 0.0F);
  EXPECT_EQ(read->depth_sigma_m.at(3, 3), 0.0123F);
  EXPECT_EQ(read->color.at(3, 3).b, 0.3F);
  EXPECT_EQ(read->color_sigma.at(3, 3), 0.004F);
  EXPECT_TRUE(read->floor->normal.isApprox(written.floor->normal, 1e-15));
  EXPECT_EQ(read->floor->offset_m, written.floor->offset_m);
}

TEST(BackgroundFile, APoseAndUnknownColoursComeBackExactly) {
  const test::TemporaryFolder folder;
  StaticBackground written = made();
  written.world_from_view = geometry::Pose{
      Eigen::Quaterniond(Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, -0.4, 0.5).normalized())),
      {1.23456789012, -0.5, 3e-7}};
  written.depth_m.at(2, 1) = 0;
  written.color.at(2, 1) = {-1, -1, -1};  // never seen
  ASSERT_TRUE(save(written, folder / "b"));
  const auto read = load_static_background(folder / "b");
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_TRUE(read->world_from_view);
  EXPECT_EQ(read->world_from_view->translation_m, written.world_from_view->translation_m);
  EXPECT_LT(read->world_from_view->rotation.angularDistance(written.world_from_view->rotation),
            1e-12);
  EXPECT_EQ(read->depth_m.at(2, 1), 0.0F);
  EXPECT_EQ(read->color.at(2, 1).r, -1);
  EXPECT_EQ(read->color.at(2, 1).b, -1);
  EXPECT_EQ(read->color.at(1, 1).r, 0.1F);
}

TEST(BackgroundFile, ARotationThatIsNoneAndAColourBelowUnknownAreToldInOneLine) {
  const test::TemporaryFolder folder;
  StaticBackground background = made();
  background.world_from_view = geometry::Pose{};
  ASSERT_TRUE(save(background, folder / "b"));
  std::string text = test::read_bytes(folder / "b/background.toml");
  const auto line = text.find("rotation_xyzw");
  ASSERT_NE(line, std::string::npos) << text;
  text.replace(line, text.find('\n', line) - line, "rotation_xyzw = [0.5, 0.0, 0.0, 0.0]");
  folder.write("b/background.toml", text);
  const auto turned = load_static_background(folder / "b");
  ASSERT_FALSE(turned);
  for (const char* part : {"background.toml:", "pose.rotation_xyzw", "must have length 1"})
    EXPECT_NE(turned.error().context.find(part), std::string::npos) << turned.error().context;
  EXPECT_EQ(turned.error().context.find('\n'), std::string::npos);

  background.color.at(0, 0).g = -1.5F;
  ASSERT_TRUE(save(background, folder / "b"));
  const auto colored = load_static_background(folder / "b");
  ASSERT_FALSE(colored);
  EXPECT_NE(colored.error().context.find("negative or not finite"), std::string::npos);
}

TEST(BackgroundFile, PreviewsShowMillimetresAndSrgb) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(save(made(), folder / "b"));
  Image<std::uint16_t> depth_mm;
  Image<Rgb8> color;
  ASSERT_TRUE(image_io::read_gray16(folder / "b/depth.png", depth_mm));
  ASSERT_TRUE(image_io::read_rgb8(folder / "b/color.png", color));
  EXPECT_EQ(depth_mm.at(0, 0), 2345);
  // Linear 0.1, 0.2, 0.3 are sRGB 89, 124, 149.
  EXPECT_EQ(color.at(0, 0), (Rgb8{89, 124, 149}));
}

TEST(BackgroundFile, WithoutAFloorHasNone) {
  const test::TemporaryFolder folder;
  StaticBackground background = made();
  background.floor.reset();
  ASSERT_TRUE(save(background, folder / "b"));
  EXPECT_FALSE(load_static_background(folder / "b")->floor);
}

TEST(BackgroundFile, AnOlderOneIsReplacedAndAForeignFolderIsRefused) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(save(made(), folder / "b"));
  ASSERT_TRUE(save(made(), folder / "b"));
  folder.write("mine/letter.txt", "dear");
  EXPECT_EQ(save(made(), folder / "mine").error().code, ErrorCode::kUsage);
  EXPECT_TRUE(std::filesystem::exists(folder / "mine/letter.txt"));
}

TEST(BackgroundFile, DamageIsToldInOneLine) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(load_static_background(folder / "none").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(save(made(), folder / "b"));
  ASSERT_TRUE(image_io::write_exr(folder / "b/depth.exr", {{"Z", Image<float>(Size{3, 3})},
                                                           {"sigma", Image<float>(Size{3, 3})}}));
  EXPECT_EQ(load_static_background(folder / "b").error().code, ErrorCode::kData);
  ASSERT_TRUE(image_io::write_exr(folder / "b/depth.exr", {{"Y", Image<float>(Size{7, 5})}}));
  EXPECT_NE(load_static_background(folder / "b").error().context.find("no channel Z"),
            std::string::npos);
  ASSERT_TRUE(save(made(), folder / "c"));
  std::string text = test::read_bytes(folder / "c/background.toml");
  text.replace(text.rfind("offset_m"), 8, "offset_n");
  folder.write("c/background.toml", text);
  EXPECT_NE(load_static_background(folder / "c").error().context.find("did you mean \"offset_m\"?"),
            std::string::npos);
}

}  // namespace
}  // namespace mixrig::model
