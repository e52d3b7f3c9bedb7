// SPDX-License-Identifier: Apache-2.0
// The examples of docs/reference are files that the program reads: no key in them is unknown.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/capture/take/manifest.h"
#include "host/scene/scene_manifest.h"

namespace mixrig::test {
namespace {

/// The first TOML block of a page of docs/reference; empty where there is none.
std::string first_example(const std::string& page) {
  const char* const root = std::getenv("MIXRIG_SOURCE");
  if (root == nullptr) return "";
  std::ifstream file(std::filesystem::path(root) / "docs" / "reference" / page);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string begin = "\n```toml\n";
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return "";
  const std::size_t from = at + begin.size();
  return text.substr(from, text.find("\n```", from) - from + 1);
}

TEST(Reference, TheExampleOfASceneIsRead) {
  const auto scene = scene::parse_scene(first_example("scene.md"), "scene.toml", false);
  ASSERT_TRUE(scene) << to_line(scene.error());
  EXPECT_EQ(scene->objects.size(), 1U);
}

TEST(Reference, TheExampleOfARigIsRead) {
  const auto rig = live::parse_rig(first_example("rig.md"), "rig.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  EXPECT_EQ(rig->cameras.size(), 1U);
}

TEST(Reference, TheExampleOfATakeIsRead) {
  const auto manifest = take::parse_manifest(first_example("take.md"), "walk/take.toml");
  ASSERT_TRUE(manifest) << to_line(manifest.error());
  EXPECT_EQ(manifest->info.color.count, 60);
}

TEST(Reference, TheExampleOfACalibrationIsRead) {
  const auto read = calibration_file::parse_calibration(first_example("calibration_file.md"), "c");
  ASSERT_TRUE(read) << to_line(read.error());
  EXPECT_EQ(read->cameras.size(), 2U);
  EXPECT_TRUE(read->pan_tilt.has_value());
}

}  // namespace
}  // namespace mixrig::test
