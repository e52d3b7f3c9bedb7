// SPDX-License-Identifier: Apache-2.0
// Text files of poses, as data sets publish them, against values worked out by hand.
#include "host/math/geometry/pose_lines.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/refusal.h"

namespace mixrig::geometry {
namespace {

constexpr const char* kEuroc =
    "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z "
    "[],v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1]\n"
    "1403636579000000000,1,2,3,0.8,-0.6,0,0,9,9,9\n";

PoseLine only_pose(const std::string& text) {
  const auto lines = parse_pose_lines(text, "p");
  EXPECT_TRUE(lines) << lines.error().context;
  if (!lines || lines->poses.size() != 1) return {};
  return lines->poses[0];
}

/// The pose that all texts below hold: a turn by -2 acos(0.8) about x.
void expect_turned(const PoseLine& pose) {
  EXPECT_EQ(pose.position_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(pose.rotation.w(), 0.8);
  EXPECT_EQ(pose.rotation.x(), -0.6);
  EXPECT_EQ(pose.rotation.y(), 0);
  EXPECT_EQ(pose.rotation.z(), 0);
}

TEST(PoseLines, ColumnsAreTakenByTheNamesOfTheHeader) {
  const PoseLine euroc = only_pose(kEuroc);
  expect_turned(euroc);
  EXPECT_NEAR(euroc.time_s, 1403636579.0, 1e-6) << "the header says nanoseconds";
  EXPECT_EQ(euroc.line, 2);
  expect_turned(only_pose("t,x,y,z,qw,qx,qy,qz\n5,1,2,3,0.8,-0.6,0,0\n"));
  expect_turned(only_pose("qx;qy;qz;qw;tx;ty;tz;time_ms\n-0.6;0;0;0.8;1;2;3;5000\n"));
  expect_turned(only_pose(
      "%time,field.header.seq,field.header.stamp,field.pose.position.x,field.pose.position.y,"
      "field.pose.position.z,field.pose.orientation.x,field.pose.orientation.y,"
      "field.pose.orientation.z,field.pose.orientation.w\n7,1,5,1,2,3,-0.6,0,0,0.8\n"));
  expect_turned(
      only_pose("# a walk\n# timestamp [s] pos_x_mm pos_y_mm pos_z_mm quat_w quat_x quat_y "
                "quat_z\n5 1000 2000 3000 0.8 -0.6 0 0\n"));
  EXPECT_EQ(only_pose("qx;qy;qz;qw;tx;ty;tz;time_ms\n-0.6;0;0;0.8;1;2;3;5000\n").time_s, 5);
}

TEST(PoseLines, ACommentMayHaveWordsBehindTheNames) {
  expect_turned(
      only_pose("# t x y z qx qy qz qw of world_from_target in z up\n"
                "5 1 2 3 -0.6 0 0 0.8\n"));
  expect_turned(only_pose("# t x y z qw qx qy qz of a tracker\n5 1 2 3 0.8 -0.6 0 0 9\n"));
  EXPECT_TRUE(test::refused(parse_pose_lines("# t x y z qx qy qz qw and more\n5 1 2 3 0 0 0 1\n"
                                             "6 1 2 3 0 0 0 1 9\n",
                                             "p.txt"),
                            {"p.txt:3: has 9 columns, not 8"}));
}

TEST(PoseLines, WithoutAHeaderTheOrderIsThatOfTum) {
  expect_turned(only_pose("# made at night, with x and y swapped back\n5 1 2 3 -0.6 0 0 0.8"));
  expect_turned(only_pose("5, 1, 2, 3, -0.6, 0, 0, 0.8,\r\n"));
  expect_turned(only_pose("5\t1 2,3;-0.6 0 0 0.8\n"));
  EXPECT_TRUE(std::isnan(only_pose("nan 1 2 3 -0.6 0 0 0.8\n").time_s));
}

TEST(PoseLines, ALineWithOtherColumnsIsRefusedWithTheOrder) {
  for (const char* bad : {"5 1 2 3 0.8 -0.6 0 0 9 9 9", "5 1 2 3 -0.6 0 0", "a b c"}) {
    const auto lines = parse_pose_lines(std::string("4 1 2 3 -0.6 0 0 0.8\n") + bad, "p.txt");
    EXPECT_TRUE(test::refused(lines, {"p.txt:2: ", "t x y z qx qy qz qw"}, ErrorCode::kFormat))
        << bad;
  }
  EXPECT_TRUE(test::refused(parse_pose_lines("t,x,y,z,qw,qx,qy,qz\n5,1,2,,0.8,-0.6,0,0\n", "p.csv"),
                            {"p.csv:2: '' is no number for z"}));
}

TEST(PoseLines, AHeaderThatLacksAColumnOrHasItTwiceIsRefused) {
  const auto refused = [](const char* header, std::initializer_list<std::string_view> words) {
    return test::refused(parse_pose_lines(std::string(header) + "\n1,1,2,3,0,0,0,1\n", "p.csv"),
                         words, ErrorCode::kFormat);
  };
  EXPECT_TRUE(refused("time,x,y,z,roll,pitch,yaw,valid", {"p.csv:1: ", "qx qy qz qw"}));
  EXPECT_TRUE(refused("time,x,y,z,rot_x,rot_y,rot_z,valid", {"no column qw"}));
  EXPECT_TRUE(refused("#frame,x,y,z,qw,qx,qy,qz", {"no column t"}));
  EXPECT_TRUE(refused("t,x,y,z,qw,qx,qy,qz,body2.pos.x", {"column x twice"}));
}

TEST(PoseLines, TimesWithoutAUnitTellItByTheirSize) {
  struct StampRow {
    const char *time, *unit;
  };
  for (const StampRow& row :
       {StampRow{"1403636579500000000", "nanoseconds"},
        StampRow{"1403636579500000", "microseconds"}, StampRow{"1403636579500", "milliseconds"},
        StampRow{"1403636579.5", ""}}) {
    const auto lines = parse_pose_lines(std::string(row.time) + " 1 2 3 0 0 0 1\n", "p");
    ASSERT_TRUE(lines) << lines.error().context;
    EXPECT_NEAR(lines->poses[0].time_s, 1403636579.5, 1e-5) << row.unit;
    EXPECT_EQ(lines->guessed_unit, row.unit);
  }
  const auto stated = parse_pose_lines(kEuroc, "p");
  ASSERT_TRUE(stated);
  EXPECT_EQ(stated->guessed_unit, "") << "the header says it";
}

}  // namespace
}  // namespace mixrig::geometry
