// SPDX-License-Identifier: Apache-2.0
// A rig of two GigE Vision cameras on the board, one of them 3D with amplitude: studio takes from
// the folder MIXRIG_BOARD_TAKES are sent over the loopback interface. The command records a board
// held by hand, calibrates the rig with it, records a walk and composites it.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "host/math/image_io/image_io.h"
#include "tests/board/rig_bench.h"
#include "tests/support/genicam/recorded_truth.h"
#include "tests/support/report_pose.h"

namespace mixrig::board {
namespace {

constexpr double kRate_hz = 1;

std::string variable(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? text : "";
}

class Genicam : public ::testing::Test {
 protected:
  void SetUp() override {
    if (takes_.empty()) GTEST_SKIP() << "MIXRIG_BOARD_TAKES names no folder";
    (void)run("ip addr add 127.0.0.2/8 dev lo");
  }
  /// Plays a take as cameras; the command records them in `out`.
  void record(const std::string& take, double rate_hz, test::GenicamDepthLayout layout,
              const std::string& out, const std::string& tables, const std::string& keys = "") {
    cameras_.reset();  // one take has the ports
    auto opened = test::GenicamTake::open(takes_ + "/" + take, rate_hz, layout);
    ASSERT_TRUE(opened) << to_line(opened.error());
    cameras_ = *std::move(opened);
    ASSERT_TRUE(cameras_->running());
    std::ofstream("/tmp/genicam.toml") << "format = 1\nname = \"genicam\"\n"
                                       << keys << cameras_->rig_tables() << tables;
    const Ran ran = run("mixrig record --rig /tmp/genicam.toml " + out + " --format png" +
                        " --duration " + std::to_string(cameras_->seconds()));
    ASSERT_EQ(ran.status, 0) << ran.text;
    std::printf("%s", ran.text.c_str());
  }
  /// Checks that every frame has both pictures of one exposure, and the depth that was sent.
  void check(const std::string& out) {
    const auto sent = test::sent_frames(out, *cameras_);
    long whole = 0;
    for (const auto& [frame, from] : sent) {
      if (from.depth == 0) continue;
      ASSERT_EQ(from.color, from.depth) << "frame " << frame;
      char name[32];
      std::snprintf(name, sizeof name, "/depth/%06d.png", frame);
      Image<std::uint16_t> picture;
      ASSERT_TRUE(image_io::read_gray16(out + name, picture));
      const auto& steps = cameras_->steps(from.color);
      bool same = picture.size().area() == steps.size();
      for (int y = 0; same && y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x)
          same =
              same && picture.at(x, y) == steps[static_cast<std::size_t>(y * picture.width() + x)];
      whole += same;
    }
    EXPECT_GE(whole, static_cast<long>(sent.size()) - 1);
    EXPECT_GE(static_cast<int>(sent.size()), cameras_->frames() - 1);
    measured("%zu sets of %d sent pairs, %ld depth pictures equal to the step", sent.size(),
             cameras_->frames(), whole);
  }
  /// Records the walk as /tmp/walk2 with `tables` and `keys` of a rig.toml, and compares its
  /// composite with that of the take itself.
  void record_and_composite_walk(const std::string& tables, const std::string& keys = "") {
    fs::remove_all("/tmp/walk2");
    record("walk", kRate_hz, test::GenicamDepthLayout::kParts, "/tmp/walk2", tables, keys);
    if (HasFatalFailure()) return;
    check("/tmp/walk2");
    test::give_truth(takes_ + "/walk", "/tmp/walk2", *cameras_);
    fs::copy(takes_ + "/walk/models", "/tmp/walk2/models", fs::copy_options::recursive);
    fs::copy(takes_ + "/walk/scene.toml", "/tmp/walk2/scene.toml");
    const auto there = composited("/tmp/walk2"), own = composited(takes_ + "/walk");
    measured("key_iou %.4f, depth %.2f mm; of the take itself %.4f, %.2f mm", there.first,
             there.second, own.first, own.second);
    EXPECT_GT(there.first, own.first - 0.01);
    EXPECT_LT(there.second, own.second + 2);
  }
  /// Runs a take and returns its key_iou and depth_mae_mm.
  static std::pair<double, double> composited(const std::string& take) {
    const Ran ran = run("mixrig run " + take + "/scene.toml --source take:" + take +
                        " --out /tmp/out --backend cpu --format none --json /tmp/run.json");
    EXPECT_EQ(ran.status, 0) << ran.text;
    std::ifstream file("/tmp/run.json");
    const auto error = nlohmann::json::parse(file).at("error");
    return {error.at("key_iou").get<double>(), error.at("depth_mae_mm").get<double>()};
  }
  const std::string takes_ = variable("MIXRIG_BOARD_TAKES");
  std::unique_ptr<test::GenicamTake> cameras_;
};

TEST_F(Genicam, AWalkIsRecordedAndComposited) {
  record_and_composite_walk(test::camera_tables(takes_ + "/walk") +
                            test::world_table(takes_ + "/walk"));
}

TEST_F(Genicam, TheRigIsCalibratedByARecordedBoard) {
  record("hand", kRate_hz, test::GenicamDepthLayout::kAbcy, "/tmp/hand", "");
  if (HasFatalFailure()) return;
  check("/tmp/hand");
  const Ran views =
      run("mixrig calibrate views /tmp/views --take /tmp/hand "
          "--board checkerboard:9x6:70mm");
  ASSERT_EQ(views.status, 0) << views.text;
  const Ran rig =
      run("mixrig calibrate rig /tmp/views --out /tmp/calibration.toml "
          "--json /tmp/calibration.json");
  ASSERT_EQ(rig.status, 0) << rig.text;
  const auto found = read_json("/tmp/calibration.json").at("cameras").at("tof");
  const auto truth = read_json(takes_ + "/hand/truth/truth.json").at("target_from_tof");
  const double off_mm = test::off_mm(found, truth), off_deg = test::off_deg(found, truth);
  measured("calibration off by %.3f mm, %.4f deg", off_mm, off_deg);
  EXPECT_LT(off_mm, 0.5);
  EXPECT_LT(off_deg, 0.05);
  record_and_composite_walk(test::world_table(takes_ + "/walk"),
                            "calibration = \"calibration.toml\"\n");
}

}  // namespace
}  // namespace mixrig::board
