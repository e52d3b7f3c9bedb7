// SPDX-License-Identifier: Apache-2.0
// A scene with an object and two lamps, and the desk that changes it.
#pragma once

#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "host/operator/desk/scene_desk.h"
#include "tests/support/hand_gltf.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {

inline constexpr const char* kDeskScene = R"(# a set
[camera]
pose = "take"

[[object]]
name = "crate"  # ours
model = "crate.glb"
position_m = [2.0, 3.0, 0.5]
yaw_deg = 10.0
scale = 2.0

[light]
ambient = 0.3

[[light.lamp]]
name = "key"
position_m = [1.0, 1.0, 2.0]
intensity = [4.0, 2.0, 1.0]

[[light.lamp]]
name = "fill"
position_m = [3.0, 1.0, 2.0]
intensity = 0.5
)";

/// A view from 2 m above the world's origin, along y and 45 degrees down.
inline SeenFrom seen_from() {
  SeenFrom from;
  from.view = {{101, 101}, 100, 100, 50, 50};
  from.world_from_view.translation_m = {0, 0, 2};
  Eigen::Matrix3d axes;  // x right, y down, z forward, in the world
  const double s = std::sqrt(0.5);
  axes << 1, 0, 0, 0, -s, s, 0, -s, -s;
  from.world_from_view.rotation = Eigen::Quaterniond(axes);
  return from;
}

/// A triangle whose lowest corner is on the level of its origin, in glTF's axes.
inline std::string desk_triangle() {
  return test::glb(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "buffers":[{"byteLength":44}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})",
      test::floats({-0.4F, 0, 0, 0.4F, 0, 0, 0, 1, 0}) + test::shorts({0, 1, 2}));
}

class Desk : public ::testing::Test {
 protected:
  Desk() {
    folder_.write("crate.glb", desk_triangle());
    write(kDeskScene);
    session_.scene = scene::load_scene(file()).value();
    follower_ = std::make_shared<SceneFollower>(session_, false);
    desk_ = std::make_unique<SceneDesk>(session_, follower_);
  }
  std::filesystem::path file() const { return folder_.path() / "scene.toml"; }
  void write(const std::string& text) const { std::ofstream(file()) << text; }
  std::string text() const {
    std::ifstream in(file());
    return {std::istreambuf_iterator<char>(in), {}};
  }
  scene::Scene written() const { return scene::load_scene(file()).value(); }

  test::TemporaryFolder folder_;
  Session session_;
  std::shared_ptr<SceneFollower> follower_;
  std::unique_ptr<SceneDesk> desk_;
  const SeenFrom from_ = seen_from();
};

inline page::SetObject move_to(double u, double v, bool preview) {
  page::SetObject set;
  set.name = "crate", set.at = Eigen::Vector2d(u, v), set.preview = preview;
  return set;
}

}  // namespace mixrig::session
