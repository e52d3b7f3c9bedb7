// SPDX-License-Identifier: Apache-2.0
// Takes made of real recordings: pictures linked, take.toml written.
#pragma once

#include <iomanip>

#include <Eigen/Geometry>

#include "tests/e2e/command.h"

namespace mixrig::test {

/// Skips where there are no recordings.
class RealTakeTest : public CommandTest {
 protected:
  void SetUp() override {
    if (std::getenv("MIXRIG_DATA") == nullptr)
      GTEST_SKIP() << "needs recordings: set MIXRIG_DATA to the folder that holds them";
  }
  static std::filesystem::path recording(const std::string& name) {
    return std::filesystem::path(std::getenv("MIXRIG_DATA")) / name;
  }
  /// Links a file as picture `number` of a stream of a take.
  void link(const std::filesystem::path& file, const std::string& take, const std::string& stream,
            int number) const {
    std::filesystem::create_directories(folder_ / take / stream);
    std::ostringstream name;
    name << std::setfill('0') << std::setw(6) << number << file.extension().string();
    std::filesystem::create_symlink(file, folder_ / take / stream / name.str());
  }
  /// Writes take.toml: pictures of `count` frames, then `rest`.
  void write_take(const std::string& take, int count, const std::string& color,
                  const std::string& rest) const {
    std::ofstream(folder_ / take / "take.toml")
        << "format = 1\nname = \"real\"\nroot = \".\"\n"
        << "[color]\npath = \"color/%06d." << color << "\"\nfirst = 1\ncount = " << count
        << "\nrate_hz = 15.0\n[depth]\npath = \"depth/%06d.png\"\nfirst = 1\ncount = " << count
        << "\nrate_hz = 15.0\nunit_m = 0.001\nunknown = 0\nkind = \"z\"\n"
        << "noise = [0.002, 0.0, 0.002]\n"
        << rest;
  }
  /// A take of every `step`th of the kitchen's 12 frames from the `first`th (0..11), with the poses
  /// that were published. Returns these.
  std::vector<Eigen::Isometry3d> write_kitchen(const std::string& take, int first, int step) const {
    const auto kitchen = recording("rgbd-kitchen-moving-camera");
    std::vector<Eigen::Isometry3d> poses;
    std::ostringstream lines;
    for (int i = first; i < 12; i += step) {
      const int number = 150 + 2 * i, at = static_cast<int>(poses.size()) + 1;
      const auto stem = kitchen / ("frame-000" + std::to_string(number));
      link(stem.string() + ".color.png", take, "color", at);
      link(stem.string() + ".depth.png", take, "depth", at);
      std::ifstream file(stem.string() + ".pose.txt");
      Eigen::Matrix4d m;
      for (int k = 0; k < 16; ++k) file >> m(k / 4, k % 4);
      EXPECT_TRUE(file) << stem;
      const Eigen::Quaterniond q(m.topLeftCorner<3, 3>());
      lines << std::setprecision(12) << number / 30.0 << ' ' << m.topRightCorner<3, 1>().transpose()
            << ' ' << q.coeffs().transpose() << '\n';
      poses.push_back(Eigen::Translation3d(m.topRightCorner<3, 1>()) * q);
    }
    std::ofstream(folder_ / take / "poses.txt") << lines.str();
    const std::string camera =
        "size_px = [640, 480]\nfx = 585.0\nfy = 585.0\ncx = 320.0\ncy = 240.0\n";
    write_take(take, static_cast<int>(poses.size()), "png",
               "[target]\n" + camera + "[tof]\n" + camera +
                   "[target_from_tof]\nrotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, "
                   "1.0]]\ntranslation_m = [0.0, 0.0, 0.0]\n[pose]\nfile = \"poses.txt\"\n");
    return poses;
  }
};

}  // namespace mixrig::test
