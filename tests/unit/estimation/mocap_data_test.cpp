// SPDX-License-Identifier: Apache-2.0
// A tracked body of a real motion-capture system: markers.csv, rigid_body.csv of mocap-natnet.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "host/math/estimation/markers/constellation.h"
#include "host/math/estimation/points/rigid_fit.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// The constellation as Motive uses it; the server of NatNet 3.0 sends it with x negated.
const Points kRaceQuad_m = {{-0.1611589938402176, 0.03505159914493561, -0.03218130022287369},
                            {0.0308190006762743, 0.03978189826011658, -0.021990099921822548},
                            {-0.1875309944152832, -0.03338329866528511, 0.1480810046195984},
                            {0.0748715028166771, 6.686070264549926e-05, 0.03292329981923103},
                            {0.05803820118308067, -0.03194189816713333, -0.13680699467658997}};

std::vector<std::vector<double>> rows_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line, cell;
  std::getline(file, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(file, line)) {
    std::vector<double> row;
    for (std::stringstream cells(line); std::getline(cells, cell, ',');)
      row.push_back(std::strtod(cell.c_str(), nullptr));
    rows.push_back(row);
  }
  return rows;
}

class MocapData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("MIXRIG_DATA");
    if (root == nullptr || !std::filesystem::exists(std::filesystem::path(root) / "mocap-natnet"))
      GTEST_SKIP()
          << "needs the recording mocap-natnet: set MIXRIG_DATA to the folder that holds it";
    const auto folder = std::filesystem::path(root) / "mocap-natnet";
    for (const auto& r : rows_of(folder / "markers.csv"))
      markers[static_cast<int>(r[0])].push_back({r[4], r[5], r[6]});
    for (const auto& r : rows_of(folder / "rigid_body.csv"))
      if (r[2] == 2)
        poses[static_cast<int>(r[0])] = {Eigen::Quaterniond(r[10], r[7], r[8], r[9]).normalized(),
                                         {r[4], r[5], r[6]}};
  }
  std::map<int, Points> markers;  // by frame, in the order sent
  std::map<int, geometry::Pose> poses;
};

TEST_F(MocapData, FitsMotivesPoseAndResidual) {
  ASSERT_GT(markers.size(), 200u);
  double squared = 0, angle = 0, distance = 0;
  int count = 0;
  for (const auto& [frame, points] : markers) {
    // Five labelled markers and a foreign one, separated by shape alone.
    const auto match = match_constellation(kRaceQuad_m, points, {0.001, 0});
    ASSERT_TRUE(match.usable()) << "frame " << frame << ": " << match.verdict.reason;
    ASSERT_EQ(match.inliers.size(), 5u);
    for (int i : match.inliers) squared += std::pow(match.residuals[i], 2), ++count;
    const auto error = pose_error(match.value.world_from_body, poses.at(frame));
    angle = std::max(angle, error.head<3>().norm());
    distance = std::max(distance, error.tail<3>().norm());
  }
  EXPECT_NEAR(std::sqrt(squared / count), 0.00067, 0.00002);
  EXPECT_LT(angle * 180 / M_PI, 0.03);
  EXPECT_LT(distance, 0.0003);
}

TEST_F(MocapData, RefusesTheConstellationAsSent) {
  Points sent = kRaceQuad_m;
  for (auto& p : sent) p.x() = -p.x();
  const Points& seen = markers.begin()->second;
  EXPECT_FALSE(match_constellation(sent, seen, {0.001, 0}).usable());
}

}  // namespace
}  // namespace mixrig::estimation
