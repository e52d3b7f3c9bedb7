// SPDX-License-Identifier: Apache-2.0
// `mixrig calibrate intrinsics` on drawn boards: its output, and its errors for bad input.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/calibration_file/exchange.h"
#include "tests/unit/calibrate/drawn_board.h"
#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

constexpr int kViews = 8;

/// A folder with drawn views view1.png ..., once for all tests.
const TinyTake& folder() {
  static const TinyTake take;
  static const bool drawn = [] {
    const auto board = *calibration::parse_board("checkerboard:9x6:25mm");
    DrawnCamera camera;
    camera.k = 0;
    const auto poses = varied_poses(board, kViews, 3, 0.45);
    for (int i = 0; i < kViews; ++i) {
      const auto image = draw_board(board, camera, poses[static_cast<std::size_t>(i)], {},
                                    static_cast<unsigned>(i));
      EXPECT_TRUE(
          image_io::write_png(take.path("view" + std::to_string(i + 1) + ".png"), image.view()));
    }
    // Held still badly, and held half out of the picture.
    DrawnLook shaken, clean;
    shaken.blur_px = 3;
    clean.noise = 0.3;  // noise costs OpenCV's finders seconds where they fail
    const auto half = board_pose(board, {0.2, 0.3, 0}, {0.28, 0, 0.45});
    EXPECT_TRUE(image_io::write_png(take.path("blurred.png"),
                                    draw_board(board, camera, poses[2], shaken, 77).view()));
    EXPECT_TRUE(image_io::write_png(take.path("half.png"),
                                    draw_board(board, camera, half, clean, 78).view()));
    EXPECT_TRUE(
        image_io::write_png(take.path("empty.png"), Image<std::uint8_t>({640, 480}, 90).view()));
    return true;
  }();
  EXPECT_TRUE(drawn);
  return take;
}

const std::string kBoardOption = " --board checkerboard:9x6:25mm ";

TEST(CalibrateIntrinsics, WritesTheCameraReportAndPicture) {
  const TinyTake& take = folder();
  const Outcome done = take.mixrig("calibrate intrinsics view?.png empty.png" + kBoardOption +
                                   "--out c.toml --json r.json --picture p.png --opencv o.yml "
                                   "--kalibr k.yaml --mrcal m.cameramodel --lens 2");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.out.find("empty.png"), std::string::npos)
      << done.out;  // the report says that it shows no board
  EXPECT_NE(done.out.find("verdict       go"), std::string::npos) << done.out;
  const auto read = calibration_file::read_calibration(take.path("c.toml"));
  ASSERT_TRUE(read) << read.error().context;
  const auto* camera = read->camera("target");
  ASSERT_NE(camera, nullptr);
  const Eigen::VectorXd v = geometry::parameters_of(camera->model);
  EXPECT_NEAR(v[0], 520, 4 * std::sqrt(camera->covariance(0, 0)));
  EXPECT_NEAR(v[2], 322.3, 4 * std::sqrt(camera->covariance(2, 2)));
  EXPECT_NEAR(v[0], 520, 0.5);
  EXPECT_LT(camera->residual_px, 0.05);
  EXPECT_EQ(camera->origin.input_hash.size(), 16U);
  for (const char* name : {"o.yml", "k.yaml", "m.cameramodel"}) {
    const auto other = calibration_file::read_cameras(take.path(name));
    ASSERT_TRUE(other) << other.error().context;
    EXPECT_EQ(geometry::parameters_of(other->front().model), v) << name;
  }
  const auto report = nlohmann::json::parse(take.text_of("r.json"));
  EXPECT_EQ(report["verdict"], "go");
  EXPECT_EQ(report["views"].size(), kViews + 1);
  EXPECT_EQ(report["uncertainty"]["sigma_px"].size(), 12U * 9U);
  EXPECT_TRUE(fs::exists(take.path("p.png")));
  // If the name already belongs to another camera, the command asks.
  take.edit("c.toml", "fx = 5", "fx = 7");
  const Outcome again =
      take.mixrig("calibrate intrinsics view?.png" + kBoardOption + "--out c.toml");
  EXPECT_EQ(again.status, 0);
  EXPECT_NE(again.err.find("swapped"), std::string::npos) << again.err;
  for (const char* name : {"c.toml", "r.json", "p.png", "o.yml", "k.yaml", "m.cameramodel"})
    fs::remove(take.path(name));
}

TEST(CalibrateIntrinsics, FindsACharucoOfTheOlderLayoutAndSaysSo) {
  const TinyTake take;
  const auto board = *calibration::parse_board("charuco:9x6:25mm:18.75mm:5X5_250");
  DrawnCamera camera;
  camera.k = 0;
  const auto poses = varied_poses(board, kViews, 4, 0.45);
  for (const bool older : {false, true}) {
    for (int i = 0; i < kViews; ++i) {
      DrawnLook look;
      look.first_is_white = older;
      const auto image = draw_board(board, camera, poses[static_cast<std::size_t>(i)], look,
                                    static_cast<unsigned>(i));
      ASSERT_TRUE(
          image_io::write_png(take.path("view" + std::to_string(i + 1) + ".png"), image.view()));
    }
    const Outcome done = take.mixrig(
        "calibrate intrinsics view?.png --board charuco:9x6:25mm:18.75mm:5X5_250 --lens 2 "
        "--json r.json");
    ASSERT_EQ(done.status, 0) << done.err;
    EXPECT_EQ(done.err, "");
    EXPECT_EQ(done.out.find("layout before 4.6") != std::string::npos, older) << done.out;
    const auto report = nlohmann::json::parse(take.text_of("r.json"));
    EXPECT_EQ(report["older_layout"], older);
    EXPECT_NEAR(report["parameters"]["fx"]["value"], 520, 0.5);
    EXPECT_GT(report["points"], 0.8 * kViews * 40);
    fs::remove(take.path("r.json"));
  }
}

TEST(CalibrateIntrinsics, TellsWhichViewsItDoesNotUse) {
  const TinyTake& take = folder();
  const Outcome done = take.mixrig("calibrate intrinsics view?.png blurred.png half.png" +
                                   kBoardOption + "--lens 2 --json r.json");
  ASSERT_EQ(done.status, 0) << done.err;
  const auto report = nlohmann::json::parse(take.text_of("r.json"));
  fs::remove(take.path("r.json"));
  ASSERT_EQ(report["views"].size(), kViews + 2);
  for (const auto& view : report["views"]) {
    const std::string name = view["name"], why = view.value("why_not", "");
    EXPECT_EQ(view["used"], name != "blurred.png" && name != "half.png") << name;
    const char* expected = name == "blurred.png" ? "blurred: "
                           : name == "half.png"  ? "not found"
                                                 : "";
    EXPECT_NE(why.find(expected), std::string::npos) << name << ": " << why;
  }
  // The verdict needs more views than these.
  const Outcome few = take.mixrig("calibrate intrinsics view1.png view2.png view3.png view4.png" +
                                  kBoardOption + "--lens 2");
  EXPECT_NE(few.out.find("no-go"), std::string::npos) << few.out;
  EXPECT_NE(few.out.find("only 4 views"), std::string::npos) << few.out;
}

TEST(CalibrateIntrinsics, RefusesBadInputInOneLine) {
  const TinyTake& take = folder();
  const auto before = take.contents();
  struct Case {
    const char *words, *expected;
    int status;
  };
  for (const Case& c :
       {Case{"view1.png --board chessboard:9x6:25mm", "not a kind of board", 2},
        Case{"view1.png absent.png --board checkerboard:9x6:25mm", "absent.png", 2},
        Case{"take/take.toml --board checkerboard:9x6:25mm", "take.toml", 2},
        Case{"empty.png --board checkerboard:9x6:25mm", "no picture shows", 1},
        Case{"view1.png view2.png --board checkerboard:9x6:25mm", "only 2 usable views", 1},
        Case{"view1.png view1.png view1.png view1.png --board checkerboard:9x6:25mm", "alike", 1},
        Case{"view1.png take/color/000001.png --board checkerboard:9x6:25mm", "is 32x24", 1},
        Case{"view1.png --board checkerboard:10x7:25mm", "shows checkerboard:9x6:25mm", 1},
        Case{"view1.png --board checkerboard:9x6:25mm --lens 3", "--lens 3", 2},
        Case{"view1.png --board checkerboard:9x6:25mm --model round", "--model", 2}}) {
    const Outcome outcome = take.mixrig("calibrate intrinsics " + std::string(c.words) +
                                        " --out bad.toml --picture bad.png");
    EXPECT_EQ(outcome.status, c.status) << c.words << ": " << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << c.words << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(c.expected), std::string::npos) << c.words << ": " << outcome.err;
  }
  EXPECT_EQ(take.contents(), before);
}

}  // namespace
}  // namespace mixrig::test
