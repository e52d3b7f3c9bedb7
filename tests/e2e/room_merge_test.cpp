// SPDX-License-Identifier: Apache-2.0
// Two sweeps of a room from two positions are joined into one room, the background of a run. The
// bounds were chosen on seeds 5 and 6: 5.9 and 6.0 mm with a sigma of 4.0, key_iou 0.934 (5).
#include <array>
#include <cmath>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

using Numbers = std::array<double, 3>;

class RoomMerge : public CommandTest {
 protected:
  void scan(const std::string& name, const std::string& eye, const std::string& look_at) {
    ASSERT_EQ(
        studio("sweep_" + name, std::string("--scenario sweep --field 200x100 --view-frames 1") +
                                    kRig + "--eye " + eye + " --look-at " + look_at),
        0);
    ASSERT_EQ(mixrig("scan --take " + path("sweep_" + name) + " --calibration " +
                     path("sweep_" + name + "/truth/calibration.toml") + " " + path(name)),
              0);
  }
  /// True pose of the head's base in the world.
  nlohmann::json foot(const std::string& name) const {
    return report("sweep_" + name + "/truth/rig.json").at("world_from_base");
  }
  static constexpr const char* kRig = " --rig sr3000 --seed 5 --plain --size 96x80 ";
};

/// Rotates `v` by the inverse of a quaternion xyzw.
Numbers turned_back(const std::array<double, 4>& q, const Numbers& v) {
  const auto cross = [](const Numbers& a, const Numbers& b) -> Numbers {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const Numbers axis{-q[0], -q[1], -q[2]};
  const Numbers once = cross(axis, v), twice = cross(axis, once);
  Numbers out = v;
  for (std::size_t k = 0; k < 3; ++k) out[k] += 2 * (q[3] * once[k] + twice[k]);
  return out;
}

TEST_F(RoomMerge, TwoPositionsBecomeOneRoomThatRunTakes) {
  ASSERT_NO_FATAL_FAILURE(scan("a", "0.9,2.1,1.5", "3.36,0.38,1.2"));
  ASSERT_NO_FATAL_FAILURE(scan("b", "2.6,3.2,1.4", "2.4,0.3,1.2"));
  ASSERT_EQ(mixrig("scan --merge " + path("a") + " " + path("b") + " " + path("joined") +
                   " --json " + path("joined.json")),
            0);
  const auto found = report("joined.json");
  const auto pose = found.at("registrations").at(0);
  EXPECT_GT(pose.at("agreeing_pct").get<double>(), 98);
  EXPECT_LT(found.at("triangles").get<int>(), found.at("triangles_alone").get<int>());
  const auto a = foot("a").at("translation_m").get<Numbers>();
  const auto b = foot("b").at("translation_m").get<Numbers>();
  const Numbers truth = turned_back(foot("a").at("rotation_xyzw").get<std::array<double, 4>>(),
                                    {b[0] - a[0], b[1] - a[1], b[2] - a[2]});
  const auto t = pose.at("translation_m").get<Numbers>();
  const double off_mm = 1e3 * std::hypot(t[0] - truth[0], t[1] - truth[1], t[2] - truth[2]);
  EXPECT_LT(off_mm, 10);
  EXPECT_LT(off_mm, 3 * pose.at("sigma_mm").get<double>());
  EXPECT_EQ(mixrig("info " + path("joined") + " --json " + path("info.json")), 0);
  EXPECT_EQ(report("info.json").at("kind").get<std::string>(), "joined room");

  // The joined room has the base of the first one.
  ASSERT_EQ(studio("take", std::string("--scenario pan --pan 30 --frames 12") + kRig +
                               "--eye 0.9,2.1,1.5 --look-at 3.36,0.38,1.2"),
            0);
  std::ifstream in(path("take/scene_pan_tilt.toml"));
  std::ofstream out(path("take/scene_room.toml"));
  for (std::string text; std::getline(in, text);)
    out << (text.starts_with("learn = ") ? "model = \"../joined\"" : text) << '\n';
  out.close();
  ASSERT_EQ(mixrig("run " + path("take/scene_room.toml") + " --source take:" + path("take") +
                   " --frames 7-12 --out " + path("out") + " --json " + path("run.json")),
            0);
  EXPECT_GT(report("run.json").at("error").at("key_iou").get<double>(), 0.9);
}

}  // namespace
}  // namespace mixrig::test
