// SPDX-License-Identifier: Apache-2.0
// Takes made of real recordings: pictures linked, take.toml written.
#pragma once

#include <iomanip>

#include <Eigen/Geometry>

#include "host/math/image_io/image_io.h"
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
  /// Writes a take of every `step`th of the kitchen's 12 frames from the `first`th (0..11) on, with
  /// their published poses. Returns these poses.
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
  /// Writes a take of the 15 pictures of a fisheye in an office, 0.3 to 1 m apart, without depth,
  /// and TAKE.toml beside it: the published intrinsics.
  void write_office(const std::string& take) const {
    constexpr int kPictures = 15;
    std::string stamps = "picture,frame,counter,mid_exposure_ns\n";
    std::filesystem::create_directories(folder_ / take / "depth");
    for (int number = 1; number <= kPictures; ++number) {
      std::ostringstream two, six;
      two << std::setfill('0') << std::setw(2) << number;
      six << std::setfill('0') << std::setw(6) << number;
      const auto picture = recording("fisheye-moving-camera") / ("Fisheye2_" + two.str() + ".jpg");
      link(picture, take, "color", number);
      link(picture, take, "fisheye", number);
      ASSERT_TRUE(image_io::write_png(folder_ / take / "depth" / (six.str() + ".png"),
                                      Image<std::uint16_t>({16, 12}).view()));
      const std::string n = std::to_string(number);
      stamps +=
          n + "," + n + "," + n + "," + std::to_string((number - 1) * 1'000'000'000LL / 15) + "\n";
    }
    std::ofstream(folder_ / take / "fisheye.csv") << stamps;
    const std::string still = "rotation_xyzw = [0, 0, 0, 1]\ntranslation_m = [0, 0, 0]\n";
    write_take(take, kPictures, "jpg",
               "[fisheye]\npath = \"fisheye/%06d.jpg\"\nfirst = 1\ncount = 15\nrate_hz = 15.0\n"
               "[target]\nsize_px = [748, 480]\nfx = 200.0\nfy = 200.0\ncx = 373.5\ncy = 239.5\n"
               "[tof]\nsize_px = [16, 12]\nfx = 15.0\nfy = 15.0\ncx = 7.5\ncy = 5.5\n"
               "[target_from_tof]\n" +
                   still);
    std::ofstream(path(take + ".toml"))
        << "format = 1\n[cameras.fisheye]\nmax_angle_rad = 1.4\nmodel = \"fisheye\"\nsize_px = "
           "[748, 480]\nfx = 209.42\nfy = 209.35\ncx = 384.82\ncy = 240.02\ndistortion = "
           "[-0.0425, -0.0025, 0.0118, -0.0084]\n[target_from.fisheye]\n"
        << still;
  }
};

}  // namespace mixrig::test
