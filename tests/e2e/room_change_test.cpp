// SPDX-License-Identifier: Apache-2.0
// A room is scanned; on another day a chair stands elsewhere and a person walks. The chair is keyed
// as a person until it is accepted.
#include <fmt/format.h>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class RoomChange : public CommandTest {
 protected:
  /// Writes the take's scene with a scanned room, whose base has the sweep's true pose.
  void write_scene(const std::string& name, const std::string& room) {
    const auto rig = nlohmann::json::parse(std::ifstream(path("sweep/truth/rig.json")));
    const auto pose = rig.at("world_from_base");
    std::ifstream in(path("take/scene.toml"));
    std::ofstream out(path("take/" + name));
    for (std::string text; std::getline(in, text);) {
      if (!text.starts_with("learn = ")) {
        out << text << '\n';
        continue;
      }
      out << "model = \"../" << room
          << "\"\nworld_from_base = { rotation_xyzw = " << pose.at("rotation_xyzw").dump()
          << ", translation_m = " << pose.at("translation_m").dump() << " }\n";
    }
  }
  nlohmann::json run(const std::string& scene, const std::string& options) {
    EXPECT_EQ(mixrig("run " + path("take/" + scene) + " --source take:" + path("take") + " " +
                     options + " --json " + path("run.json")),
              0);
    return report("run.json");
  }
  static double iou(const nlohmann::json& run) {
    return run.at("error").at("key_iou").get<double>();
  }
};

constexpr double kWas_m[] = {4.2, 3.55},
                 kIs_m[] = {3.5, 3.0};  ///< position of the chair on the floor, metres

double off_m(const nlohmann::json& place, const double (&truth)[2]) {
  return std::hypot(place[0].get<double>() - truth[0], place[1].get<double>() - truth[1]);
}

TEST_F(RoomChange, AMovedChairIsFoundAndBecomesBackground) {
  const std::string rig =
      " --rig kinect2 --seed 5 --plain --size 160x128 --eye 0.9,2.1,1.5 --look-at 3.9,3.2,0.7 ";
  ASSERT_EQ(studio("sweep", "--scenario sweep --field 100x90 --view-frames 2" + rig), 0);
  ASSERT_EQ(mixrig("scan --take " + path("sweep") + " --calibration " +
                   path("sweep/truth/calibration.toml") + " " + path("room")),
            0);
  ASSERT_EQ(studio("take", "--scenario walk --moved-chair --frames 150" + rig), 0);
  write_scene("before.toml", "room");
  const auto found =
      run("before.toml",
          "--accept-changes --change-after 2.5 --frames 1-150 --save-room " + path("accepted"));
  const auto& changes = found.at("room_changes").at("found");
  ASSERT_EQ(changes.size(), 1U) << changes.dump();
  EXPECT_EQ(changes[0].at("kind"), "moved");
  EXPECT_TRUE(changes[0].at("accepted").get<bool>());
  EXPECT_LT(off_m(changes[0].at("center_m"), kIs_m), 0.15) << changes.dump();
  // At the chair's old position the camera sees only one side of it.
  EXPECT_LT(off_m(changes[0].at("from_m"), kWas_m), 0.2) << changes.dump();
  write_scene("after.toml", "accepted");
  const double before = iou(run("before.toml", "--frames 131-150"));
  const auto saved = run("after.toml", "--watch --change-after 2.5 --frames 101-150");
  EXPECT_TRUE(saved.at("room_changes").at("found").empty()) << saved.dump();
  const double after = iou(run("after.toml", "--frames 131-150"));
  EXPECT_LT(before, 0.3) << "the chair counts as a person";
  EXPECT_GT(after, 0.8);
  RecordProperty("before", fmt::format("{:.3f}", before));
  RecordProperty("after", fmt::format("{:.3f}", after));
}

}  // namespace
}  // namespace mixrig::test
