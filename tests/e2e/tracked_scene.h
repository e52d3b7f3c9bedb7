// SPDX-License-Identifier: Apache-2.0
// The scene of a studio take whose camera is tracked in a scanned room.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mixrig::test {

/// Where the room of a studio sweep truly stands.
inline nlohmann::json world_from_base(const std::string& take) {
  std::ifstream file(take + "/truth/rig.json");
  return nlohmann::json::parse(file).at("world_from_base");
}

/// The take's own scene with the tracker and the scanned room.
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

}  // namespace mixrig::test
