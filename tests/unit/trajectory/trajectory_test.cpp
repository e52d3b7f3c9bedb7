// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/trajectory.h"

#include <cmath>
#include <cstdint>
#include <filesystem>

#include <gtest/gtest.h>

#include "host/math/estimation/verdict.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::trajectory {
namespace {

Trajectory spin(double step_s, int count) {
  std::vector<TimedPose> samples;
  for (int i = 0; i < count; ++i) {
    const double t = i * step_s;
    samples.push_back({t, {estimation::rotation_exp({0, 0, t * t}), {t * t * t, 0, 0}}});
  }
  return Trajectory(std::move(samples));
}

TEST(Trajectory, FollowsACubicExactlyBetweenSamples) {
  const auto pose = spin(0.1, 20).at(0.73);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation_m.x(), std::pow(0.73, 3), 1e-12);
  EXPECT_NEAR(estimation::rotation_log(pose->rotation).z(), 0.73 * 0.73, 1e-12);
}

TEST(Trajectory, MakesNothingUpInGapsAndOutside) {
  auto samples = spin(0.1, 30).samples();
  samples.erase(samples.begin() + 10, samples.begin() + 15);  // 0.9 .. 1.5 s
  const Trajectory trajectory(samples);
  EXPECT_TRUE(trajectory.at(0.85));
  EXPECT_FALSE(trajectory.at(1.2));
  EXPECT_TRUE(trajectory.at(1.55));
  EXPECT_FALSE(trajectory.at(-0.01));
  EXPECT_FALSE(trajectory.at(2.95));
  EXPECT_FALSE(trajectory.at(NAN));
  EXPECT_TRUE(trajectory.at(2.9));
}

class TrajectoryFile : public ::testing::Test {
 protected:
  Result<Trajectory> read(const std::string& text) {
    return read_trajectory(folder_.write("trajectory.txt", text));
  }
  test::TemporaryFolder folder_;  // tests of this file run beside each other
};

TEST_F(TrajectoryFile, ReadsTumAndCsv) {
  const auto tum = read("# t x y z qx qy qz qw\n1.5 1 2 3 0 0 0 1\n2.5 1 2 4 0 0 1 0\n");
  ASSERT_TRUE(tum);
  EXPECT_EQ(tum->samples().size(), 2u);
  EXPECT_EQ(tum->samples()[1].world_from_body.translation_m.z(), 4);
  const auto csv = read("t,x,y,z,qx,qy,qz,qw\r\n1.5, 1, 2, 3, 0, 0, 0, 1\r\n");
  ASSERT_TRUE(csv);
  EXPECT_EQ(csv->samples().size(), 1u);
}

/// One motion as two publishers write it: the order of the columns is that of the header.
TEST_F(TrajectoryFile, TakesColumnsByTheirNames) {
  const auto tum = read("1.5 1 2 3 -0.6 0 0 0.8\n2.5 1 2 4 0 0.6 0 0.8\n");
  const auto csv = read("t,x,y,z,qw,qx,qy,qz\n1.5,1,2,3,0.8,-0.6,0,0\n2.5,1,2,4,0.8,0,0.6,0\n");
  const auto euroc = read(
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z "
      "[],b_w_RS_S_x [rad "
      "s^-1]\n1500000000,1,2,3,0.8,-0.6,0,0,7\n2500000000,1,2,4,0.8,0,0.6,0,7\n");
  ASSERT_TRUE(tum && csv && euroc);
  for (const auto* other : {&*csv, &*euroc}) {
    ASSERT_EQ(other->samples().size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(other->samples()[i].t_s, tum->samples()[i].t_s, 1e-9);
      EXPECT_EQ(other->samples()[i].world_from_body, tum->samples()[i].world_from_body);
    }
  }
  EXPECT_FALSE(read("t,x,y,z,roll,pitch,yaw,valid\n1.5,1,2,3,0,0,0,1\n"));
}

TEST_F(TrajectoryFile, NamesTheBrokenLine) {
  const auto broken = read("1.5 1 2 3 0 0 0 1\n2.5 1 2 three 0 0 0 1\n");
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().context.find(":2:"), std::string::npos) << broken.error().context;
  EXPECT_FALSE(read("1 2 3\n"));
  EXPECT_FALSE(read("1 2 3 4 5 6 7 8 9\n"));
  EXPECT_EQ(read_trajectory("/nowhere/at/all").error().code, ErrorCode::kNotFound);
  const auto path = folder_.write("large.txt", "");
  std::filesystem::resize_file(path, (std::uintmax_t{1} << 30) + 1);  // takes no room on the disk
  const auto large = read_trajectory(path);
  ASSERT_FALSE(large);
  EXPECT_NE(large.error().context.find("larger"), std::string::npos) << large.error().context;
  const auto empty = read("");
  ASSERT_TRUE(empty);
  EXPECT_TRUE(empty->empty());
}

}  // namespace
}  // namespace mixrig::trajectory
