// SPDX-License-Identifier: Apache-2.0
// Studio takes are sent by two emulated GigE Vision cameras, one of them 3D with amplitude: they
// are recorded, views are chosen, the rig is calibrated, and a walk is composited with that
// calibration. Each figure is compared with the one of the take itself. Run it by own_network.sh.
#include <cstdio>
#include <map>
#include <thread>

#include "host/math/image_io/image_io.h"
#include "tests/e2e/rig_error.h"
#include "tests/support/child_process.h"
#include "tests/support/genicam/genicam_take.h"
#include "tests/support/genicam/recorded_truth.h"

namespace mixrig::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double kRate_hz = 10;
constexpr int kLimit_s = 300;  // of a recording; long enough for a loaded machine

class GenicamRun : public CommandTest {
 protected:
  /// Plays the studio take `take` as cameras and records them as `out`.
  std::unique_ptr<GenicamTake> record(const std::string& take, const std::string& out,
                                      GenicamDepthLayout layout, const std::string& keys = "",
                                      const std::string& tables = "") const {
    auto cameras = GenicamTake::open(path(take), kRate_hz, layout);
    EXPECT_TRUE(cameras) << to_line(cameras.error());
    if (!cameras || !(*cameras)->running()) return nullptr;
    std::ofstream(path("rig.toml")) << "format = 1\nname = \"genicam\"\n"
                                    << keys << (*cameras)->rig_tables() << tables;
    (*cameras)->wait_for([pictures = path(out) + ".partial/color/", count = 0]() mutable {
      char name[16];
      for (;; ++count) {
        std::snprintf(name, sizeof name, "%06d.png", count + 1);
        if (!fs::exists(pictures + name)) return count;
      }
    });
    ChildProcess recorder({MIXRIG_COMMAND, "record", "--rig", path("rig.toml"), path(out),
                           "--format", "png", "--duration", "3600"},
                          kLimit_s, path("record.log"));
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kLimit_s);
    while (!(*cameras)->finished() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    recorder.signal(SIGINT);
    EXPECT_EQ(recorder.wait(), 0) << text_of_file(path("record.log"));
    return *std::move(cameras);
  }
  /// Runs a scene and returns key_iou and depth_mae_mm.
  std::pair<double, double> composited(const std::string& scene, const std::string& take,
                                       const std::string& more = "") const {
    EXPECT_EQ(
        mixrig("run " + path(scene) + " --source take:" + path(take) + " --out " + path("out") +
               " --backend cpu --format none --json " + path("run.json") + more),
        0);
    const json error = report("run.json").at("error");
    return {error.at("key_iou").get<double>(), error.at("depth_mae_mm").get<double>()};
  }
  json calibrated(const std::string& take, const std::string& name) const {
    EXPECT_EQ(mixrig("calibrate views " + path(name) + " --take " + path(take) +
                     " --board checkerboard:9x6:70mm"),
              0);
    EXPECT_EQ(mixrig("calibrate rig " + path(name) + " --out " + path(name + ".toml") + " --json " +
                     path(name + ".json")),
              0);
    return report(name + ".json");
  }
};

/// Expects for each recorded frame that the counters of both cameras agree and that the depth is
/// what was sent.
void expect_what_was_sent(const fs::path& take, const GenicamTake& cameras) {
  const auto sent = sent_frames(take, cameras);
  int whole = 0;
  for (const auto& [frame, from] : sent) {
    if (from.depth == 0) continue;
    ++whole;
    ASSERT_EQ(from.color, from.depth) << "frame " << frame << " pairs two times";
    char name[32];
    std::snprintf(name, sizeof name, "depth/%06d.png", frame);
    Image<std::uint16_t> picture;
    ASSERT_TRUE(image_io::read_gray16(take / name, picture));
    const auto& steps = cameras.steps(from.color);
    ASSERT_EQ(picture.size().area(), steps.size());
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x)
        ASSERT_EQ(picture.at(x, y), steps[static_cast<std::size_t>(y * picture.width() + x)]);
  }
  ASSERT_GE(whole, cameras.frames() / 2);
}

TEST_F(GenicamRun, ACameraLikeHelios2IsRecordedCalibratedAndComposited) {
  const std::string rig = " --plain --rig helios2 --seed 21 --size 320x256 ";
  ASSERT_EQ(studio("board",
                   rig + "--scenario board --hand --views 8" +
                       " --fisheye-size 64x64 --rest 0.4 --move 0.2 --tremor 0.05 --tolerance 0"),
            0);
  leave_out_fisheye(path("board/take.toml"));  // too small to show the board
  ASSERT_EQ(studio("walk", rig + "--scenario walk --frames 20"), 0);
  {
    const auto cameras = record("board", "board2", GenicamDepthLayout::kAbcy);
    ASSERT_NE(cameras, nullptr);
    ASSERT_NO_FATAL_FAILURE(expect_what_was_sent(path("board2"), *cameras));
  }
  const json truth = report("board/truth/truth.json").at("target_from_tof");
  const json direct = calibrated("board", "views"), live = calibrated("board2", "views2");
  const auto error = [&](const json& found) {
    const json& tof = found.at("cameras").at("tof");
    return std::pair{off_mm(tof, truth), off_deg(tof, truth)};
  };
  std::printf("calibration: %.3f mm, %.4f deg; of the take itself %.3f mm, %.4f deg\n",
              error(live).first, error(live).second, error(direct).first, error(direct).second);
  EXPECT_LT(error(live).first, 0.5);
  EXPECT_LT(error(live).second, 0.05);

  const auto cameras = record("walk", "walk2", GenicamDepthLayout::kParts,
                              "calibration = \"views2.toml\"\n", world_table(path("walk")));
  ASSERT_NE(cameras, nullptr);
  ASSERT_NO_FATAL_FAILURE(expect_what_was_sent(path("walk2"), *cameras));
  give_truth(path("walk"), path("walk2"), *cameras);
  fs::copy(path("walk/models"), path("walk2/models"), fs::copy_options::recursive);
  fs::copy(path("walk/scene.toml"), path("walk2/scene.toml"));
  const auto own = composited("walk/scene.toml", "walk"),
             there = composited("walk2/scene.toml", "walk2");
  std::printf("key_iou %.4f, depth %.2f mm; of the take itself %.4f, %.2f mm\n", there.first,
              there.second, own.first, own.second);
  EXPECT_GT(there.first, own.first - 0.01);
  EXPECT_LT(there.second, own.second + 2);
}

}  // namespace
}  // namespace mixrig::test
