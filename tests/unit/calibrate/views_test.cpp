// SPDX-License-Identifier: Apache-2.0
// Board views chosen from captures: a board drawn by the tests' own camera, held still, moving,
// trembling, blurred, or not there.
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "host/calibrate/rig/view_set.h"
#include "host/calibrate/views/mean_capture.h"
#include "host/calibrate/views/turn_plan.h"
#include "host/calibrate/views/view_collector.h"
#include "host/math/image_io/image_io.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/calibrate/drawn_capture.h"

namespace mixrig::test {
namespace {

using namespace calibration;
using capture::Capture;

constexpr double kDegree = M_PI / 180;
constexpr int kWindow = 5;
const BoardSpec& kViewBoard = kDrawnBoard;

class Views : public ::testing::Test {
 protected:
  ViewCollector& start(CollectSettings settings = {}) {
    settings.board = kViewBoard;
    settings.frames = kWindow, settings.still_time = std::chrono::milliseconds(150);
    auto made = ViewCollector::create(folder_.path() / "out", source_info(),
                                      frame(0, facing(0, 0, 0.7)), settings);
    EXPECT_TRUE(made) << made.error().context;
    return collector_.emplace(*std::move(made));
  }
  /// State of the last of `count` frames.
  CollectState feed(int count, const std::function<Capture(int)>& make) {
    CollectState state = CollectState::kNoBoard;
    for (int i = 0; i < count; ++i) {
      Capture c = make(++number_);
      const auto added = collector_->add(c);
      EXPECT_TRUE(added) << added.error().context;
      state = *added;
      kept_ += state == CollectState::kKept ? 1 : 0;
    }
    return state;
  }
  TemporaryFolder folder_;
  std::optional<ViewCollector> collector_;
  int number_ = 0, kept_ = 0;
};

TEST_F(Views, ABoardAtRestIsKeptOnceAndItsMeanIsWritten) {
  start();
  const geometry::Pose pose = facing(0.02, 0.01, 0.7);
  EXPECT_EQ(feed(kWindow, [&](int n) { return frame(n, pose); }), CollectState::kKept);
  EXPECT_EQ(feed(7, [&](int n) { return frame(n, pose); }), CollectState::kKnown);
  EXPECT_EQ(kept_, 1);
  EXPECT_EQ(feed(kWindow, [&](int n) { return frame(n, facing(-0.05, 0.03, 0.9)); }),
            CollectState::kKept);
  ASSERT_TRUE(collector_->finish());
  const auto set = read_view_set(folder_.path() / "out");
  ASSERT_TRUE(set) << set.error().context;
  EXPECT_EQ(set->views, 2);
  EXPECT_EQ(set->columns, 10);
  EXPECT_EQ(set->cameras.size(), 2U);
  EXPECT_TRUE(set->cameras[1].depth_is_z);
  EXPECT_TRUE(set->angles.empty());
  // The mean of five frames has less noise than one.
  const auto view = load_view(*set, set->cameras[0], 1);
  ASSERT_TRUE(view);
  const auto mean = detect_board(view->gray, kViewBoard);
  const auto one = detect_board(gray_of(frame(99, pose).plate), kViewBoard);
  ASSERT_TRUE(mean && *mean && one && *one);
  const auto truth = true_px(kViewBoard, kColor, pose);
  const auto rms = [&](const BoardView& seen) {
    double sum = 0;
    for (std::size_t i = 0; i < seen.px.size(); ++i)
      sum += (seen.px[i] - truth[static_cast<std::size_t>(seen.ids[i])]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(seen.px.size()));
  };
  EXPECT_LT(rms(**mean), 0.65 * rms(**one));
  // Each pixel has a different one of eleven values from frame to frame.
  const auto depth = load_view(*set, set->cameras[1], 1);
  ASSERT_TRUE(depth);
  EXPECT_NEAR(depth->depth_m.at(80, 70), 0.8, 0.006);
}

TEST_F(Views, AMovingBoardIsNeverKept) {
  start();
  // 25 px a second at 300 px focal length; from frame to frame one pixel.
  feed(15, [&](int n) { return frame(n, facing(-0.06 + 0.0023 * n, 0, 0.7)); });
  EXPECT_EQ(kept_, 0);
  EXPECT_EQ(collector_->counts().still, 0);
  EXPECT_GT(collector_->counts().least_motion_px, 0.25);
  const std::string why = collector_->why_none("").context;
  EXPECT_NE(why.find("never at rest"), std::string::npos) << why;
}

TEST_F(Views, TremorAboveTheLimitIsRefusedAndBelowItKept) {
  // 8 Hz sideways at 0.7 m: 1 mm is 0.43 px.
  const auto tremble = [](double amplitude_m) {
    return [amplitude_m](int n) {
      return frame(n, facing(0.02 + amplitude_m * std::sin(2 * M_PI * 8 * 0.04 * n), 0, 0.7));
    };
  };
  start();
  feed(14, tremble(1.5e-3));
  EXPECT_EQ(kept_, 0);
  feed(14, tremble(2.5e-4));
  EXPECT_EQ(kept_, 1);
}

TEST_F(Views, ABoardThatOnlyTheDepthCameraSeesMoveIsNotKept) {
  start();
  const geometry::Pose pose = facing(0.02, 0.01, 0.7);
  feed(9, [&](int n) {
    const geometry::Pose moved = facing(0.02 + 0.004 * (n % 2), 0.01, 0.7);
    return frame(n, pose, 0.6, &moved);
  });
  EXPECT_EQ(kept_, 0);
  EXPECT_GT(collector_->counts().moving_tof, 0);
  feed(9, [&](int n) { return frame(n, pose, 0.6, nullptr, 0.02 * (n % 2)); });
  EXPECT_EQ(kept_, 0) << "the depth jumps by 2 cm";
  feed(kWindow, [&](int n) { return frame(n, pose); });
  EXPECT_EQ(kept_, 1);
}

TEST_F(Views, ABlurredBoardIsNotKeptBesideSharpOnes) {
  start();
  feed(kWindow, [&](int n) { return frame(n, facing(0.02, 0.01, 0.7)); });
  ASSERT_EQ(kept_, 1);
  EXPECT_EQ(feed(6, [&](int n) { return frame(n, facing(-0.04, 0, 0.7), 2.2); }),
            CollectState::kBlurred);
  EXPECT_EQ(kept_, 1);
}

TEST_F(Views, SayWhatWasSeenWhereThereIsNoBoard) {
  start();
  feed(3, [&](int n) {
    Capture c = frame(n, facing(0, 0, 0.7));
    for (int y = 0; y < c.plate.height(); ++y)
      for (int x = 0; x < c.plate.width(); ++x) c.plate.at(x, y) = {90, 90, 90};
    return c;
  });
  const std::string why = collector_->why_none("").context;
  EXPECT_NE(why.find("none of 3 frames shows the board checkerboard:9x6:40mm"), std::string::npos)
      << why;
  const std::string other = collector_->why_none("checkerboard:8x5:40mm").context;
  EXPECT_NE(other.find("give --board checkerboard:8x5:40mm"), std::string::npos) << other;
}

TEST_F(Views, NothingIsThereBeforeFinishAndAnglesAreWrittenWhereTheUnitTurned) {
  CollectSettings settings;
  settings.every_place = true;
  start(settings);
  for (int view = 0; view < 2; ++view)
    feed(kWindow, [&](int n) {
      Capture c = frame(n, facing(0.05 * view, 0.01, 0.7));
      c.pan_tilt = device::PanTiltAngles{0.07 * view, -0.02};
      return c;
    });
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
  ASSERT_TRUE(collector_->finish());
  const auto set = read_view_set(folder_.path() / "out");
  ASSERT_TRUE(set) << set.error().context;
  ASSERT_EQ(set->angles.size(), 2U);
  EXPECT_NEAR(set->angles[1].pan_rad, 0.07, 1e-8);
  EXPECT_NEAR(set->angles[1].tilt_rad, -0.02, 1e-8);
}

TEST(BoardMotion, IsWhatTheCornersMoveByAndTheirNoise) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<BoardView> views(8);
  for (int v = 0; v < 8; ++v)
    for (int i = 0; i < 54; ++i) {
      views[static_cast<std::size_t>(v)].ids.push_back(i);
      views[static_cast<std::size_t>(v)].px.emplace_back(20 * (i % 9) + noise(random),
                                                         20 * (i / 9) + noise(random));
    }
  BoardMotion motion = board_motion(views);
  EXPECT_NEAR(motion.noise_px, 0.05, 0.005);
  EXPECT_LT(motion.most_px, 3 * motion.chance_px);
  EXPECT_TRUE(is_still(motion, 0.01));
  for (auto& px : views[3].px) px.x() += 0.4;
  motion = board_motion(views);
  EXPECT_NEAR(motion.most_px, 0.4 * 7 / 8, 0.03);
  EXPECT_NEAR(motion.noise_px, 0.05, 0.005);
  EXPECT_FALSE(is_still(motion, 0.25));
}

TEST(Coverage, TiltIsTheSideThatIsNearerAndSetsNeedItAll) {
  const geometry::CameraModel lens = source_info().target;
  const auto seen = [&](const geometry::Pose& pose) {
    BoardView view;
    const auto px = true_px(kViewBoard, kColor, pose);
    for (int i = 0; i < 54; ++i) view.ids.push_back(i);
    view.px = px;
    return view;
  };
  // Turned about the picture's down axis by a positive angle the right side goes away.
  const auto tilt = board_tilt(seen(facing(0, 0, 0.7, {0, 30 * kDegree, 0})), kViewBoard, lens);
  ASSERT_TRUE(tilt);
  const auto points = board_points_m(kViewBoard);
  const geometry::Pose pose = facing(0, 0, 0.7, {0, 30 * kDegree, 0});
  const bool right_is_nearer = (pose * points[8]).z() < (pose * points[0]).z();
  EXPECT_EQ(tilt->x() < 0, right_is_nearer);
  EXPECT_NEAR(std::abs(tilt->x()), 0.5, 0.05);
  Coverage coverage(kViewBoard, {{ViewRole::kTarget, "target", kColor.size_px}}, lens, 2);
  const SeenBoards middle{seen(facing(0, 0, 0.7))};
  EXPECT_GT(coverage.gain(middle), 0);
  coverage.add(middle);
  EXPECT_FALSE(coverage.is_new(middle));
  EXPECT_TRUE(coverage.is_new({seen(facing(0.1, 0, 0.7))}));
  EXPECT_FALSE(coverage.enough());
  EXPECT_FALSE(coverage.advice().empty());
}

/// A slower fisheye, as a take or a rig has it: each picture in several captures, the first of them
/// exposed before the board came to rest, the last after.
TEST(MeanOf, FisheyePicturesCountOnceAndByTheirOwnTimes) {
  using namespace std::chrono_literals;
  constexpr std::array<int, 6> kPicture{1, 2, 2, 3, 3, 4};
  std::vector<Capture> captures(kPicture.size());
  std::vector<const Capture*> window;
  for (std::size_t i = 0; i < captures.size(); ++i) {
    Capture& c = captures[i];
    const int picture = kPicture[i];
    c.mid_exposure = HostTime(1s + 40ms * static_cast<int>(i));
    c.plate.reset({2, 2}), c.depth_m.reset({2, 2}, 1.0F);
    const auto grey = static_cast<std::uint8_t>(picture == 2 ? 100 : picture == 3 ? 140 : 250);
    c.fisheye.reset({2, 2}, Rgb8{grey, grey, grey});
    c.fisheye_counter = static_cast<std::uint64_t>(picture);
    c.fisheye_mid_exposure = HostTime(picture == 4 ? 1201ms : 890ms + 100ms * picture);
    window.push_back(&c);
  }
  const StillView view = mean_of(window, 0.001);
  ASSERT_FALSE(view.fisheye.empty());
  EXPECT_EQ(view.fisheye.at(1, 1).g, 120) << "of the second and the third";
}

TEST(TurnPlan, StaysWithinReachAndLimitsAndCoversBothSides) {
  const device::PanTiltInfo unit{{}, {}, {1e-3, 1e-3}, {-0.1, -1}, {0.4, 1}};
  const auto angles = turn_angles({0.02, 0}, {0.3, 0.2}, 20, unit);
  ASSERT_EQ(angles.size(), 20U);
  EXPECT_EQ(angles[0].pan_rad, 0.02);
  double low = 1, high = -1, down = 1, up = -1;
  for (const auto& a : angles) {
    low = std::min(low, a.pan_rad), high = std::max(high, a.pan_rad);
    down = std::min(down, a.tilt_rad), up = std::max(up, a.tilt_rad);
  }
  EXPECT_GE(low, -0.1);
  EXPECT_LT(low, -0.05);
  EXPECT_GT(high, 0.2);
  EXPECT_LE(high, 0.32);
  EXPECT_LT(down, -0.12);
  EXPECT_GT(up, 0.12);
}

TEST(ViewBoard, ThatLooksTheSameFromBothSidesOrThatViewsCannotHoldIsRefused) {
  EXPECT_TRUE(check_view_board(kViewBoard));
  EXPECT_FALSE(check_view_board({BoardKind::kCheckerboard, 9, 7, 0.04, 0, 0, {}}));
  EXPECT_FALSE(check_view_board({BoardKind::kAprilgrid, 6, 6, 0.088, 0, 0.026, {}}));
  EXPECT_TRUE(check_view_board({BoardKind::kCharuco, 14, 9, 0.04, 0.03, 0, "5X5_250"}));
}

/// One view of two cameras, whose depth has 0, 65535 and 1200 in its first three pixels.
class ViewDepth : public ::testing::Test {
 protected:
  Result<ViewPictures> load(const std::string& keys) {
    constexpr Size kSize{32, 24};
    for (const char* name : {"target", "tof", "depth"})
      std::filesystem::create_directories(folder_ / name);
    EXPECT_TRUE(image_io::write_png(folder_ / "target/000001.png", Image<Rgb8>(kSize).view()));
    Image<std::uint16_t> depth(kSize, 2000);
    EXPECT_TRUE(image_io::write_png(folder_ / "tof/000001.png", depth.view()));
    depth.at(0, 0) = 0, depth.at(1, 0) = 65535, depth.at(2, 0) = 1200;
    EXPECT_TRUE(image_io::write_png(folder_ / "depth/000001.png", depth.view()));
    folder_.write(
        "views.toml",
        "format = 1\nname = \"v\"\nviews = 1\n[board]\ncolumns = 9\nrows = 6\nsquare_mm = "
        "30\n[[camera]]\nname = \"target\"\nsize_px = [32, 24]\nimages = "
        "\"target/%06d.png\"\n[[camera]]\nname = \"tof\"\nsize_px = [32, 24]\nimages = "
        "\"tof/%06d.png\"\ndepth = \"depth/%06d.png\"\ndepth_unit_m = 0.001\n" +
            keys);
    MIXRIG_ASSIGN(const ViewSet set, read_view_set(folder_.path()));
    return load_view(set, set.cameras[1], 1);
  }
  TemporaryFolder folder_;
};

TEST_F(ViewDepth, SeveralStepsMayMeanNoMeasurement) {
  const auto plain = load("");
  ASSERT_TRUE(plain) << plain.error().context;
  EXPECT_EQ(plain->depth_m.at(0, 0), 0.0F);
  EXPECT_FLOAT_EQ(plain->depth_m.at(1, 0), 65.535F);
  const auto stated = load("depth_unknown = [0, 65535, 1200]\n");
  ASSERT_TRUE(stated) << stated.error().context;
  for (int x = 0; x < 3; ++x) EXPECT_EQ(stated->depth_m.at(x, 0), 0.0F) << x;
  EXPECT_FLOAT_EQ(stated->depth_m.at(3, 0), 2.0F);
  EXPECT_TRUE(refused(load("depth_unknown = 0.5\n"), {"camera", "depth_unknown", "whole steps"}));
}

TEST_F(ViewDepth, Of8BitsIsRefused) {
  ASSERT_TRUE(load(""));
  ASSERT_TRUE(image_io::write_png(folder_ / "depth/000001.png",
                                  Image<std::uint8_t>(Size{32, 24}, 100).view()));
  const auto set = read_view_set(folder_.path());
  ASSERT_TRUE(set);
  EXPECT_TRUE(refused(load_view(*set, set->cameras[1], 1), {"has 8 bits a pixel: depth needs 16"}));
}

}  // namespace
}  // namespace mixrig::test
