// SPDX-License-Identifier: Apache-2.0
// `mixrig scan` on real recordings: a Kinect that moves through a kitchen, and an Azure Kinect on a
// table.
#include "tests/e2e/real_take.h"

namespace mixrig::test {
namespace {

class RealRoom : public RealTakeTest {
 protected:
  nlohmann::json scanned() {
    EXPECT_EQ(mixrig("scan --take " + path("take/take.toml") + " " + path("room") + " --json " +
                     path("room.json")),
              0);
    return report("room.json");
  }
};

TEST_F(RealRoom, PosedFramesOfAKitchenBecomeAModel) {
  write_kitchen("take", 0, 1);
  const auto report = scanned();
  EXPECT_EQ(report.at("views"), 12);
  EXPECT_GT(report.at("fill_pct").get<double>(), 80);
  EXPECT_GT(report.at("triangles").get<int>(), 500);
  // Consistency only: the error of the recording's own poses is one to two centimetres.
  const auto& overlaps = report.at("overlaps");
  EXPECT_GT(overlaps.at("places").get<int>(), 3000);
  EXPECT_GT(overlaps.at("median_mm").get<double>(), 0.5);
  EXPECT_LT(overlaps.at("median_mm").get<double>(), 20);
}

TEST_F(RealRoom, OneViewOfAnAzureKinectBecomesAModel) {
  const auto azure = recording("azure-kinect-raw");
  for (int i = 0; i < 3; ++i) {
    link(azure / "color_0.jpg", "take", "color", i + 1);
    link(azure / ("depth_" + std::to_string(i) + ".png"), "take", "depth", i + 1);
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
  write_take("take", 3, "jpg", rest.str());
  const auto report = scanned();
  EXPECT_EQ(report.at("views"), 3);
  EXPECT_GT(report.at("triangles").get<int>(), 500);
  // The same view three times: only noise is left.
  EXPECT_LT(report.at("overlaps").at("median_mm").get<double>(), 4);
}

}  // namespace
}  // namespace mixrig::test
