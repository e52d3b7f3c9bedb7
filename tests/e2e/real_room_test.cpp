// SPDX-License-Identifier: Apache-2.0
// `mixrig scan` on real recordings: a Kinect that moves through a kitchen, and an Azure Kinect on a
// table.
#include <iomanip>

#include <Eigen/Geometry>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

namespace fs = std::filesystem;

class RealRoom : public CommandTest {
 protected:
  void SetUp() override {
    if (std::getenv("MIXRIG_DATA") == nullptr)
      GTEST_SKIP() << "needs recordings: set MIXRIG_DATA to the folder that holds them";
    for (const char* stream : {"color", "depth"}) fs::create_directories(folder_ / stream);
  }
  static fs::path recording(const std::string& name) {
    return fs::path(std::getenv("MIXRIG_DATA")) / name;
  }
  void link(const fs::path& file, const std::string& stream, int number) const {
    std::ostringstream name;
    name << std::setfill('0') << std::setw(6) << number << file.extension().string();
    fs::create_symlink(file, folder_ / stream / name.str());
  }
  /// Writes take.toml: pictures of `count` frames, then `rest`.
  void write_take(int count, const std::string& color, const std::string& rest) const {
    std::ofstream(folder_ / "take.toml")
        << "format = 1\nname = \"real\"\nroot = \".\"\n"
        << "[color]\npath = \"color/%06d." << color << "\"\nfirst = 1\ncount = " << count
        << "\nrate_hz = 15.0\n[depth]\npath = \"depth/%06d.png\"\nfirst = 1\ncount = " << count
        << "\nrate_hz = 15.0\nunit_m = 0.001\nunknown = 0\nkind = \"z\"\n"
        << "noise = [0.002, 0.0, 0.002]\n"
        << rest;
  }
  nlohmann::json scanned() {
    EXPECT_EQ(mixrig("scan --take " + path("take.toml") + " " + path("room") + " --json " +
                     path("room.json")),
              0);
    return report("room.json");
  }
};

TEST_F(RealRoom, PosedFramesOfAKitchenBecomeAModel) {
  const fs::path kitchen = recording("rgbd-kitchen-moving-camera");
  std::ofstream poses(folder_ / "poses.txt");
  int count = 0;
  for (int number = 150; number <= 172; number += 2, ++count) {
    const fs::path stem = kitchen / ("frame-000" + std::to_string(number));
    link(stem.string() + ".color.png", "color", count + 1);
    link(stem.string() + ".depth.png", "depth", count + 1);
    std::ifstream file(stem.string() + ".pose.txt");
    Eigen::Matrix4d m;
    for (int i = 0; i < 16; ++i) file >> m(i / 4, i % 4);
    ASSERT_TRUE(file) << stem;
    const Eigen::Quaterniond q(m.topLeftCorner<3, 3>());
    poses << std::setprecision(12) << number / 30.0 << ' ' << m.topRightCorner<3, 1>().transpose()
          << ' ' << q.coeffs().transpose() << '\n';
  }
  poses.close();
  const std::string camera =
      "size_px = [640, 480]\nfx = 585.0\nfy = 585.0\ncx = 320.0\ncy = 240.0\n";
  write_take(count, "png",
             "[target]\n" + camera + "[tof]\n" + camera +
                 "[target_from_tof]\nrotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, "
                 "1.0]]\ntranslation_m = [0.0, 0.0, 0.0]\n[pose]\nfile = \"poses.txt\"\n");
  const auto report = scanned();
  EXPECT_EQ(report.at("views"), 12);
  EXPECT_GT(report.at("fill_pct").get<double>(), 80);
  EXPECT_GT(report.at("triangles").get<int>(), 500);
  // Consistency: the recording's own poses are good to a centimetre or two.
  const auto& overlaps = report.at("overlaps");
  EXPECT_GT(overlaps.at("places").get<int>(), 3000);
  EXPECT_GT(overlaps.at("median_mm").get<double>(), 0.5);
  EXPECT_LT(overlaps.at("median_mm").get<double>(), 20);
}

TEST_F(RealRoom, OneViewOfAnAzureKinectBecomesAModel) {
  const fs::path azure = recording("azure-kinect-raw");
  for (int i = 0; i < 3; ++i) {
    link(azure / "color_0.jpg", "color", i + 1);
    link(azure / ("depth_" + std::to_string(i) + ".png"), "depth", i + 1);
  }
  std::ifstream file(azure / "intrinsics_derived.json");
  const auto cameras = nlohmann::json::parse(file);
  const auto camera = [&](const char* name) {
    const auto& c = cameras.at(name);
    const auto& k = c.at("K");
    std::ostringstream out;
    out << "size_px = [" << c.at("width") << ", " << c.at("height") << "]\nfx = " << k[0][0]
        << "\nfy = " << k[1][1] << "\ncx = " << k[0][2] << "\ncy = " << k[1][2]
        << "\ndistortion = " << c.at("dist_opencv_k1k2p1p2k3k4k5k6") << "\n";
    return out.str();
  };
  std::ostringstream rest;
  rest << "[target]\n"
       << camera("color") << "[tof]\n"
       << camera("depth") << "[target_from_tof]\nrotation = " << cameras.at("R_color_from_depth")
       << "\ntranslation_m = " << cameras.at("T_color_from_depth_m")
       << "\n[pose]\nworld_from_target = { rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, "
          "-1.0, 0.0]], translation_m = [0.0, 0.0, 1.0] }\n";
  write_take(3, "jpg", rest.str());
  const auto report = scanned();
  EXPECT_EQ(report.at("views"), 3);
  EXPECT_GT(report.at("triangles").get<int>(), 500);
  // The same place thrice: only noise is left.
  EXPECT_LT(report.at("overlaps").at("median_mm").get<double>(), 4);
}

}  // namespace
}  // namespace mixrig::test
