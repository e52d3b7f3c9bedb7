// SPDX-License-Identifier: Apache-2.0
// Ratios of lamps by pictures of the fisheye at several exposures.
#include "host/room/lamps/lights_bracket.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr Size kSize{96, 96};

/// Two lamps in the dark: 40 and 10 times white, of 12x12 and 16x16 pixels.
class LightsBracket : public ::testing::Test {
 protected:
  LightsBracket() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-bracket-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    const auto ray = [&](const Vector2d& px) { return geometry::unproject(camera_, px); };
    views_.push_back({{}, lights::find_bright_regions(shot(1), ray)});
    EXPECT_EQ(views_[0].regions.size(), 2U);
    for (int region = 0; region < 2; ++region) {
      lights::FoundLamp lamp;
      lamp.seen.push_back({0, region});
      lamps_.push_back(lamp);
    }
  }
  ~LightsBracket() override { fs::remove_all(folder_); }

  static Image<Rgb8> shot(double exposure, Size size = kSize) {
    Image<Rgb8> picture(size);
    const auto fill = [&](int x0, int y0, int side, double light) {
      const double v = 255 * srgb_from_linear(std::min(1.0, exposure * light));
      const auto byte = static_cast<std::uint8_t>(std::lround(v));
      for (int y = y0; y < y0 + side; ++y)
        for (int x = x0; x < x0 + side; ++x) picture.at(x, y) = {byte, byte, byte};
    };
    fill(20, 30, 12, 40), fill(60, 50, 16, 10);
    return picture;
  }
  BracketFile file(const std::string& name, double exposure, Size size = kSize) const {
    EXPECT_TRUE(image_io::write_png(folder_ / name, shot(exposure, size).view()));
    return {folder_ / name, exposure};
  }
  Result<std::vector<double>> radiance(const std::vector<BracketFile>& files, int view = 0) const {
    return radiance_by_bracket(files, camera_, views_, view, lamps_);
  }
  static std::string refusal(const Result<std::vector<double>>& result) {
    EXPECT_FALSE(result);
    return result ? "" : result.error().context;
  }

  fs::path folder_;
  geometry::AnyCamera camera_ = geometry::FisheyeModel({kSize, 40, 40, 47.5, 47.5, {}});
  std::vector<lights::LampView> views_;
  std::vector<lights::FoundLamp> lamps_;
};

TEST_F(LightsBracket, TellsRatiosOfWhatSaturates) {
  const auto found = radiance({file("a.png", 1), file("b.png", 1.0 / 16), file("c.png", 1.0 / 64)});
  ASSERT_TRUE(found) << found.error().context;
  const bool first_is_bright = views_[0].regions[0].centre_px.x() < 40;
  const double ratio = first_is_bright ? (*found)[0] / (*found)[1] : (*found)[1] / (*found)[0];
  EXPECT_NEAR(ratio, 4, 0.1);
}

TEST_F(LightsBracket, RefusesWhatDoesNotTell) {
  const BracketFile a = file("a.png", 1), b = file("b.png", 1.0 / 16);
  EXPECT_NE(refusal(radiance({a})).find("two pictures"), std::string::npos);
  EXPECT_NE(refusal(radiance({a, b})).find("add one of a shorter exposure"), std::string::npos);
  EXPECT_NE(refusal(radiance({a, file("small.png", 1, {90, 96})})).find("is 90x96"),
            std::string::npos);
  EXPECT_NE(refusal(radiance({a, file("c.png", 1.0 / 64)}, 1)).find("does not show found lamp 1"),
            std::string::npos);
  const Image<Rgb8> dark(kSize);
  ASSERT_TRUE(image_io::write_png(folder_ / "dark.png", dark.view()));
  const BracketFile black{folder_ / "dark.png", 1};
  EXPECT_NE(refusal(radiance({black, black})).find("is black"), std::string::npos);
  EXPECT_NE(refusal(radiance({a, {folder_ / "none.png", 1}})).find("none.png"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::session
