// SPDX-License-Identifier: Apache-2.0
// A studio take whose camera is tracked in a scanned room, and its scene.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/e2e/command.h"

namespace mixrig::test {

/// True pose of the room of a studio sweep.
inline nlohmann::json world_from_base(const std::string& take) {
  std::ifstream file(take + "/truth/rig.json");
  return nlohmann::json::parse(file).at("world_from_base");
}

/// Returns the take's own scene with the tracker and the scanned room added.
inline std::string tracker_scene(const std::string& take, const std::string& room,
                                 const nlohmann::json& place) {
  std::ifstream file(take + "/scene.toml");
  std::stringstream text;
  text << file.rdbuf();
  std::string scene = text.str();
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = scene.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    const auto end = scene.find('\n', at);
    if (at != std::string::npos) scene.replace(at, end - at, to);
  };
  replace("pose = ", "pose = \"tracker\"");
  replace("learn = ", "model = \"" + room + "\"\nworld_from_base = { rotation_xyzw = " +
                          place.at("rotation_xyzw").dump() +
                          ", translation_m = " + place.at("translation_m").dump() + " }");
  return "calibration = \"truth/calibration.toml\"\n" + scene;
}

/// A scanned room "room", and in it a hand-held take "take" with a fisheye. Seed 33: the tracker's
/// bounds were chosen on seeds 5 and 6.
class TrackedTake : public CommandTest {
 protected:
  void make_room_and_take(int frames) {
    const std::string rig = " --rig sr3000 --seed 33 --plain --size 160x128";
    ASSERT_EQ(studio("sweep", "--scenario sweep --field 150x100 --view-frames 1" + rig), 0);
    ASSERT_EQ(mixrig("scan --take " + path("sweep") + " --calibration " +
                     path("sweep/truth/calibration.toml") + " " + path("room")),
              0);
    ASSERT_EQ(
        studio("take", "--scenario handheld --eye 1.2,2.1,1.4 --look-at 3.2,2.1,0.5 --frames " +
                           std::to_string(frames) + " --fisheye --fisheye-size 320x256" + rig),
        0);
  }
};

}  // namespace mixrig::test
