// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate intrinsics --model fisheye on pictures with an image circle, drawn by formula.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/capture/calibration_file/calibration.h"
#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

using Eigen::Vector3d;

constexpr Size kRoundSize{480, 360};
/// theta_d = theta; the circle is that of 90 degrees.
constexpr double kFocal_px = 108, kCx_px = 242, kCy_px = 178, kSquare_m = 0.025;
constexpr int kRoundViews = 7;
const std::string kWords = " --board checkerboard:9x6:25mm --model fisheye --camera fisheye ";

/// Grey of the board of 10 x 7 squares with a white margin, and of a room behind it.
double grey_at(const geometry::Pose& board_from_camera, double x_px, double y_px, int view) {
  const double x = x_px - kCx_px, y = y_px - kCy_px, r = std::hypot(x, y);
  const double theta = r / kFocal_px;
  if (theta > M_PI / 2) return 8;
  const double s = r > 0 ? std::sin(theta) / r : 1 / kFocal_px;
  const Vector3d ray = board_from_camera.rotation * Vector3d(s * x, s * y, std::cos(theta));
  const Vector3d& eye = board_from_camera.translation_m;
  const Vector3d at = eye - eye.z() / ray.z() * ray;
  const double u = at.x() / kSquare_m + 1, v = at.y() / kSquare_m + 1;
  const bool hit = eye.z() * ray.z() < 0 && u > -1 && v > -1 && u < 11 && v < 8;
  if (!hit) return 110 + 60 * std::sin(0.03 * x_px + view) * std::cos(0.04 * y_px - view);
  const bool inside = u >= 0 && v >= 0 && u < 10 && v < 7;
  const int parity = static_cast<int>(std::floor(u)) + static_cast<int>(std::floor(v));
  return inside && parity % 2 == 0 ? 30 : 210;
}

Image<std::uint8_t> draw_view(int view) {
  const double phi = 2.4 * view, theta = view == 0 ? 0.1 : 0.65;
  const Vector3d ray(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                     std::cos(theta));
  const Eigen::Quaterniond facing = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), ray) *
                                    Eigen::AngleAxisd(0.4 * std::cos(phi), Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(0.4 * std::sin(2 * phi), Vector3d::UnitY());
  const geometry::Pose camera_from_board{facing, 0.2 * ray - facing * Vector3d(0.1, 0.0625, 0)};
  const geometry::Pose board_from_camera = inverse(camera_from_board);
  constexpr int kSub = 4;
  Image<std::uint8_t> picture(kRoundSize);
  for (int y = 0; y < kRoundSize.height; ++y)
    for (int x = 0; x < kRoundSize.width; ++x) {
      double sum = 0;
      for (int k = 0; k < kSub * kSub; ++k)
        sum += grey_at(board_from_camera, x + (k % kSub + 0.5) / kSub - 0.5,
                       y + (k / kSub + 0.5) / kSub - 0.5, view);
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround(sum / (kSub * kSub)));
    }
  return picture;
}

class CalibrateCircular : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    take_ = new TinyTake;
    for (int i = 0; i < kRoundViews; ++i)
      ASSERT_TRUE(image_io::write_png(take_->path("round" + std::to_string(i) + ".png"),
                                      draw_view(i).view()));
  }
  static void TearDownTestSuite() { delete take_; }
  static double angle_deg(const std::string& file) {
    const auto read = calibration_file::read_calibration(take_->path(file));
    EXPECT_TRUE(read) << read.error().context;
    return read ? geometry::max_angle_rad(read->camera("fisheye")->model).value_or(0) * 180 / M_PI
                : -1;
  }
  static inline TinyTake* take_ = nullptr;
};

TEST_F(CalibrateCircular, FindsTheCircleAndWritesItsAngle) {
  const Outcome done = take_->mixrig("calibrate intrinsics round?.png" + kWords +
                                     "--out c.toml --json r.json --opencv o.yml --picture p.png");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.out.find("image circle  (242.0, 178.0) px, radius 169."), std::string::npos)
      << done.out;
  EXPECT_NE(done.err.find("OpenCV and Kalibr files hold no largest angle"), std::string::npos)
      << done.err;
  EXPECT_NEAR(angle_deg("c.toml"), 90, 0.3);
  const auto field = nlohmann::json::parse(take_->text_of("r.json"))["field"];
  EXPECT_NEAR(field["circle"]["radius_px"].get<double>(), kFocal_px * M_PI / 2, 0.4);
  EXPECT_NEAR(field["largest_deg"].get<double>(), angle_deg("c.toml"), 1e-9);
  EXPECT_GT(field["points_deg"].get<double>(), 55);
}

TEST_F(CalibrateCircular, TakesTheCircleThatIsGivenOrNone) {
  const std::string words = "calibrate intrinsics round?.png" + kWords + "--lens 2 ";
  const Outcome given = take_->mixrig(words + "--image-circle 242,178,150 --out g.toml");
  ASSERT_EQ(given.status, 0) << given.err;
  EXPECT_NE(given.out.find("radius 150.0 px, as given"), std::string::npos) << given.out;
  EXPECT_NEAR(angle_deg("g.toml"), 150 / kFocal_px * 180 / M_PI, 0.3);
  const Outcome none = take_->mixrig(words + "--image-circle none --out n.toml");
  ASSERT_EQ(none.status, 0) << none.err;
  EXPECT_EQ(angle_deg("n.toml"), 0);
}

TEST_F(CalibrateCircular, RefusesABadCircleInOneLine) {
  for (const char* circle : {"1,2", "1,2,3,4", "a,b,c", "1,2,", "240,180,-5", "nan,1,100",
                             "240,180,inf", "240,180,0", "1e300,1,100", "''", "240,180,100px"}) {
    const Outcome done = take_->mixrig("calibrate intrinsics round?.png" + kWords +
                                       "--out bad.toml --image-circle " + circle);
    EXPECT_EQ(done.status, 2) << circle << ": " << done.err;
    EXPECT_EQ(done.error_lines(), 1) << done.err;
    EXPECT_FALSE(fs::exists(take_->path("bad.toml")));
  }
  const Outcome pinhole = take_->mixrig(
      "calibrate intrinsics round?.png --board checkerboard:9x6:25mm --image-circle 1,2,100");
  EXPECT_EQ(pinhole.status, 2) << pinhole.err;
  EXPECT_NE(pinhole.err.find("--model fisheye"), std::string::npos) << pinhole.err;
}

}  // namespace
}  // namespace mixrig::test
