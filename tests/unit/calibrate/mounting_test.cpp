// SPDX-License-Identifier: Apache-2.0
// Mounting of a camera whose pictures number the corners of a board otherwise than the target
// camera's: from poses, and from drawn pictures.
#include "host/calibrate/rig/mounting.h"

#include <cmath>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/calibrate/rig/calibrate_rig.h"
#include "host/math/image_io/image_io.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/calibrate/drawn_board.h"

namespace mixrig::calibration {
namespace {

constexpr double kMountDegree = M_PI / 180;
constexpr int kMountedViews = 9;

geometry::Pose rolled(double roll_deg) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(roll_deg * kMountDegree, Eigen::Vector3d::UnitZ())),
          {0.06, 0.01, 0.02}};
}

/// Views by two cameras, with poses and numbered corners but no pictures.
struct Posed {
  RigData data;
  RigModel rig, single;
  std::vector<bool> placed = std::vector<bool>(kMountedViews, true);
};

/// `spun`: the board turns about its normal alone, always in one place. Every third view of the
/// second camera is numbered from the other end.
Posed posed(int columns, int rows, bool spun) {
  constexpr double kMountSquare_m = 0.06;
  Posed out;
  out.data.set.columns = columns, out.data.set.rows = rows;
  out.data.set.square_m = kMountSquare_m;
  out.data.set.views = kMountedViews;
  out.rig.cameras.resize(2);
  out.rig.cameras[0].name = "target", out.rig.cameras[1].name = "tof";
  const Eigen::Vector3d middle(0.5 * columns * kMountSquare_m, 0.5 * rows * kMountSquare_m, 0);
  const auto turned = [](double x, double y, double z) {
    return Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ());
  };
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.003);
  for (int view = 0; view < kMountedViews; ++view) {
    const double around = 2.4 * view;
    const Eigen::Quaterniond q(spun ? turned(0.4, 0, around)
                                    : turned(0.4 * std::cos(around), 0.4 * std::sin(around), 0));
    const Eigen::Vector3d place(spun ? 0 : 0.1 * std::cos(3 * around), 0, 1);
    const geometry::Pose seen{q, place - q * middle};
    const Eigen::Quaterniond shaken(turned(noise(random), noise(random), noise(random)));
    geometry::Pose other = rolled(180) * seen;
    other.rotation = shaken * other.rotation;
    const std::vector<SeenCorner> numbered{{{1, 2}, {0, 0}}};
    std::vector<SeenCorner> corners = numbered;
    if (view % 3 == 0) turn_numbering(out.data.set, 2, corners, other);
    out.rig.target_from_board.push_back(seen);
    out.single.target_from_board.push_back(other);
    out.data.corners.emplace_back(std::vector<std::vector<SeenCorner>>{numbered, corners});
  }
  return out;
}

TEST(Mounting, numbers_the_views_so_that_they_agree) {
  for (const auto& [columns, rows] : {std::pair(9, 7), std::pair(10, 8), std::pair(7, 7)}) {
    Posed p = posed(columns, rows, false);
    const auto found = find_mounting(p.data, p.rig, p.placed, 1, p.single);
    ASSERT_TRUE(found) << found.error().context;
    EXPECT_LT(found->rotation.angularDistance(rolled(180).rotation), 1 * kMountDegree);
    EXPECT_LT((found->translation_m - rolled(180).translation_m).norm(), 0.02);
    for (const auto& view : p.data.corners)
      EXPECT_LT((view[1][0].uv - Eigen::Vector2d(1, 2)).norm(), 1e-9);
  }
}

TEST(Mounting, is_refused_where_two_numberings_agree_with_all_views) {
  Posed p = posed(9, 7, true);
  const auto found = find_mounting(p.data, p.rig, p.placed, 1, p.single);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kData);
  for (const char* word : {"looks the same upside down", "\"tof\"", "odd by an even number"})
    EXPECT_NE(found.error().context.find(word), std::string::npos) << found.error().context;
  // With a board whose ends differ nothing is open, but every third view is wrong.
  Posed distinct = posed(10, 7, true);
  EXPECT_TRUE(find_mounting(distinct.data, distinct.rig, distinct.placed, 1, distinct.single));
}

TEST(Mounting, a_turn_of_the_numbering_keeps_what_is_seen) {
  const Posed p = posed(7, 7, false);
  for (const int turns : alike_turns(p.data.set)) {
    std::vector<SeenCorner> corners{{{1, 2}, {0, 0}}, {{5, 3}, {0, 0}}};
    const std::vector<SeenCorner> before = corners;
    geometry::Pose pose = p.rig.target_from_board[1];
    const geometry::Pose was = pose;
    turn_numbering(p.data.set, turns, corners, pose);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto at = [](const SeenCorner& c) {
        return Eigen::Vector3d(0.06 * c.uv.x(), 0.06 * c.uv.y(), 0);
      };
      EXPECT_LT((pose * at(corners[i]) - was * at(before[i])).norm(), 1e-12) << turns;
    }
    EXPECT_LT(angle_between(p.data.set, pose, was), 1e-6);
  }
}

/// A folder of views drawn for two cameras, the second one rolled.
ViewSet drawn_views(const test::TemporaryFolder& folder, const BoardSpec& board, double roll_deg,
                    bool first_is_white) {
  const bool charuco = board.kind == BoardKind::kCharuco;
  const int more = charuco ? 0 : 1;
  std::string text = fmt::format(
      "format = 1\nviews = {}\n[board]\nkind = \"{}\"\ncolumns = {}\nrows = {}\nsquare_mm = {}\n",
      kMountedViews, charuco ? "charuco" : "checkerboard", board.columns + more, board.rows + more,
      1000 * board.square_m);
  if (charuco)
    text += fmt::format("marker_mm = {}\ndictionary = \"5X5_250\"\n", 1000 * board.marker_m);
  const test::DrawnCamera cameras[2] = {{{400, 320}, 380, 201.3, 157.2, 0},
                                        {{360, 360}, 330, 177.4, 181.6, 0}};
  test::DrawnLook look;
  look.first_is_white = first_is_white;
  const auto poses = test::varied_poses(board, kMountedViews, 5, 1.05);
  for (int c = 0; c < 2; ++c) {
    const std::string name = c == 0 ? "target" : "second";
    text += fmt::format(
        "[[camera]]\nname = \"{}\"\nmodel = \"pinhole\"\nsize_px = [{}, {}]\n"
        "images = \"{}/%06d.png\"\n",
        name, cameras[c].size_px.width, cameras[c].size_px.height, name);
    std::filesystem::create_directories(folder.path() / name);
    for (int i = 0; i < kMountedViews; ++i) {
      const auto seen = c == 0 ? poses[static_cast<std::size_t>(i)]
                               : rolled(roll_deg) * poses[static_cast<std::size_t>(i)];
      const auto image =
          test::draw_board(board, cameras[c], seen, look, static_cast<unsigned>(10 * i + c));
      EXPECT_TRUE(image_io::write_png(folder.path() / fmt::format("{}/{:06}.png", name, i + 1),
                                      image.view()));
    }
  }
  std::ofstream(folder.path() / "views.toml") << text;
  const auto set = read_view_set(folder.path());
  EXPECT_TRUE(set);
  return *set;
}

void expect_mounted(const RigReport& report, double roll_deg, const std::string& what) {
  const geometry::Pose& found = report.model.cameras[1].camera_from_target;
  EXPECT_LT(found.rotation.angularDistance(rolled(roll_deg).rotation), 0.3 * kMountDegree) << what;
  EXPECT_LT((found.translation_m - rolled(roll_deg).translation_m).norm(), 0.004) << what;
  for (const Misfound& wrong : report.misfound) EXPECT_TRUE(wrong.views.empty()) << what;
}

TEST(RolledCamera, is_placed_by_a_board_that_looks_alike_upside_down) {
  for (const auto& [text, roll_deg] :
       {std::pair("checkerboard:8x6:60mm", 180.0), std::pair("checkerboard:9x7:50mm", 137.0),
        std::pair("checkerboard:7x7:55mm", 90.0), std::pair("checkerboard:6x6:60mm", -90.0),
        std::pair("checkerboard:8x6:60mm", 0.0)}) {
    const test::TemporaryFolder folder;
    const ViewSet set = drawn_views(folder, *parse_board(text), roll_deg, false);
    RigOptions options;
    options.pixels = false, options.threads = 1;
    const auto report = calibrate_rig(set, options, [](const char*, int, int) {});
    const std::string what = fmt::format("{} rolled by {}", text, roll_deg);
    ASSERT_TRUE(report) << what << ": " << report.error().context;
    expect_mounted(*report, roll_deg, what);
  }
}

TEST(FirstSquare, may_be_white_in_all_pixels_of_a_rig) {
  for (const char* text : {"charuco:9x6:55mm:41mm:5X5_250", "checkerboard:9x7:50mm"}) {
    std::vector<double> grey_of_black;  // residuals with the usual print, drawn likewise
    for (const bool white : {false, true}) {
      const test::TemporaryFolder folder;
      const ViewSet set = drawn_views(folder, *parse_board(text), 180, white);
      RigOptions options;
      options.threads = 1;
      const auto report = calibrate_rig(set, options, [](const char*, int, int) {});
      ASSERT_TRUE(report) << text << ": " << report.error().context;
      EXPECT_EQ(report->first_is_white, white) << text;
      expect_mounted(*report, 180, text);
      if (!white) grey_of_black = report->grey_rms;
      for (std::size_t c = 0; c < 2; ++c)
        EXPECT_NEAR(report->grey_rms[c], grey_of_black[c], 0.1 * grey_of_black[c]) << text;
    }
  }
}

}  // namespace
}  // namespace mixrig::calibration
