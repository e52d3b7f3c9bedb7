// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "host/math/estimation/verdict.h"
#include "host/pose/mocap/constellation_file.h"
#include "host/pose/mocap/marker_file.h"
#include "host/pose/mocap/track.h"
#include "tests/support/random_geometry.h"

namespace mixrig::mocap {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr const char* kHat = R"(name = "hat"
sigma_m = 0.0005
[[marker]]
position_m = [0.0, 0.0, 0.0]
[[marker]]
position_m = [0.1, 0.0, 0.0]
[[marker]]
position_m = [0.0, 0.17, 0.0]
[[marker]]
position_m = [0.03, 0.05, 0.12]
)";

TEST(ConstellationFile, ReadsMarkers) {
  const auto body = parse_constellation(kHat, "hat.toml");
  ASSERT_TRUE(body) << body.error().context;
  EXPECT_EQ(body->name, "hat");
  ASSERT_EQ(body->markers_m.size(), 4u);
  EXPECT_EQ(body->markers_m[2], Vector3d(0, 0.17, 0));
}

TEST(ConstellationFile, NamesTheBrokenLine) {
  const auto error_of = [](const std::string& text) {
    const auto body = parse_constellation(text, "hat.toml");
    return body ? std::string() : body.error().context;
  };
  EXPECT_NE(error_of("[[marker]]\nposition_m = [1, 2]\n").find("hat.toml:2"), std::string::npos);
  EXPECT_NE(error_of("").find("3 to 64"), std::string::npos);
  EXPECT_NE(error_of(std::string(kHat) + "[[marker]]\nplace = [1, 2, 3]\n").find("place"),
            std::string::npos);
  EXPECT_NE(error_of("[[marker").find("hat.toml:1"), std::string::npos);
  // A square is ambiguous: it has rotational symmetry.
  std::string square;
  for (const char* p : {"0, 0", "1, 0", "1, 1", "0, 1"})
    square += "[[marker]]\nposition_m = [" + std::string(p) + ", 0]\n";
  EXPECT_NE(error_of(square).find("same when turned"), std::string::npos) << error_of(square);
  EXPECT_EQ(read_constellation("/nowhere/hat.toml").error().code, ErrorCode::kNotFound);
}

TEST(MocapCsv, ReadsMarkersAndBodies) {
  const auto markers = parse_mocap_csv(
      "frame,t_s,model_id,marker_id,x_m,y_m,z_m,size_m,occluded\r\n"
      "7,1.5,2,1,0.1,0.2,0.3,0.02,0\r\n7,1.5,2,2,0.4,0.5,0.6,0.02,1\n8,1.6,2,1,0,0,0,0,0\n",
      "m.csv");
  ASSERT_TRUE(markers) << markers.error().context;
  ASSERT_EQ(markers->size(), 2u);
  EXPECT_EQ((*markers)[0].markers.size(), 2u);
  EXPECT_TRUE((*markers)[0].markers[1].occluded);
  EXPECT_EQ((*markers)[0].markers[0].position_m, Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ((*markers)[1].time_s, 1.6);
  const auto bodies = parse_mocap_csv(
      "frame,t_s,id,valid,x_m,y_m,z_m,qx,qy,qz,qw\n1,0,5,1,1,2,3,0,0,1,0\n2,1,5,0,1,2,3,0,0,0,1\n"
      "3,2,5,1,1,2,3,0,0,0,0\n",
      "b.csv");
  ASSERT_TRUE(bodies) << bodies.error().context;
  ASSERT_EQ(bodies->size(), 3u);
  EXPECT_TRUE((*bodies)[0].bodies[0].tracked);
  EXPECT_FALSE((*bodies)[1].bodies[0].tracked);
  EXPECT_FALSE((*bodies)[2].bodies[0].tracked) << "no rotation at all";
}

TEST(MocapCsv, NamesTheBrokenLine) {
  const auto error_of = [](const std::string& text) {
    const auto frames = parse_mocap_csv(text, "m.csv");
    return frames ? std::string() : frames.error().context;
  };
  EXPECT_NE(error_of("frame,t_s,x_m,y_m,z_m\n1,0,1,2,3\n2,0,1,two,3\n").find("m.csv:3: column y_m"),
            std::string::npos);
  EXPECT_NE(error_of("frame,t_s,x_m,y_m,z_m\n1,0,1\n").find("m.csv:2: column y_m"),
            std::string::npos);
  EXPECT_NE(error_of("frame,t_s,x_m,y_m,z_m\n1,nan,1,2,3\n").find("t_s"), std::string::npos);
  EXPECT_NE(error_of("frame,t_s,x_m,y_m,z_m\n1e300,0,1,2,3\n").find("frame"), std::string::npos);
  EXPECT_NE(error_of("1,2,3\n").find("no column frame"), std::string::npos);
  EXPECT_NE(error_of("frame,t_s,x_m,y_m,z_m,qx\n").find("qy"), std::string::npos);
  EXPECT_NE(error_of("").find("empty"), std::string::npos);
}

/// A body that walks and turns; its first marker is hidden in every fifth frame, all of them in
/// one, and a foreign one is always there.
std::vector<stream::NatNetFrame> walk(const Constellation& body, std::vector<Pose>& truth) {
  test::RandomGeometry random(4);
  std::vector<stream::NatNetFrame> frames;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.1 * i;
    const Pose pose{estimation::rotation_exp({0.3 * std::sin(t), 0.8 * t, 0.2}),
                    {t, 1.2, -0.5 * t}};
    truth.push_back(pose);
    stream::NatNetFrame frame{i, t, {}, {}};
    for (std::size_t m = 0; m < body.markers_m.size(); ++m)
      frame.markers.push_back({0, 0, pose * body.markers_m[m] + random.normal3(0.0003),
                               (m == 0 && i % 5 == 4 && body.markers_m.size() > 4) || i == 20, 0});
    frame.markers.push_back({0, 0, {3, 0, 3}, false, 0});
    std::reverse(frame.markers.begin(), frame.markers.end());
    frames.push_back(frame);
  }
  return frames;
}

TEST(TrackMarkers, FindsTheBodyInEveryFrameThatShowsIt) {
  auto body = *parse_constellation(kHat, "hat.toml");
  body.markers_m.emplace_back(-0.07, -0.02, 0.04);
  std::vector<Pose> truth;
  const auto frames = walk(body, truth);
  TrackOptions options;
  options.up = Up::kZ;
  options.body_from_camera = {estimation::rotation_exp({0, 0.3, 0}), {0.02, 0, 0.1}};
  const auto track = track_markers(frames, body, options);
  EXPECT_EQ(track.frames, 40);
  ASSERT_EQ(track.poses.size(), 39u);
  EXPECT_EQ(track.refused.size(), 1u);
  EXPECT_NEAR(track.residual_rms_m, 0.0003 * std::sqrt(3), 0.0002);
  for (const TrackedPose& p : track.poses) {
    const Pose expected = truth[std::lround(10 * p.time_s)] * options.body_from_camera;
    const auto error = estimation::pose_error(p.world_from_camera, expected);
    EXPECT_LT(error.head<3>().norm(), 0.02);
    EXPECT_LT(error.tail<3>().norm(), 0.002);
  }
}

TEST(TrackBodies, ConvertsToZUpAndChoosesTheBody) {
  stream::NatNetFrame frame{1, 2.5, {}, {}};
  frame.bodies.push_back({5, {Eigen::Quaterniond::Identity(), {1, 2, 3}}, 0, true});
  const auto track = track_bodies({frame, {2, 2.6, {}, {}}}, {});
  ASSERT_TRUE(track) << track.error().context;
  ASSERT_EQ(track->poses.size(), 1u);
  EXPECT_EQ(track->frames, 2);
  // The direction that was up (y) is up (z) afterwards; the height stays 2.
  EXPECT_LT((track->poses[0].world_from_camera.translation_m - Vector3d(1, -3, 2)).norm(), 1e-12);
  EXPECT_LT(
      (track->poses[0].world_from_camera.rotation * Vector3d::UnitY() - Vector3d::UnitZ()).norm(),
      1e-12);
  frame.bodies.push_back({6, {}, 0, true});
  const auto two = track_bodies({frame}, {});
  ASSERT_FALSE(two);
  EXPECT_NE(two.error().context.find("5 6"), std::string::npos) << two.error().context;
  TrackOptions other;
  other.body_id = 7;
  EXPECT_FALSE(track_bodies({frame}, other));
  EXPECT_FALSE(track_bodies({}, {}));
}

TEST(Tum, WritesOneLineAPose) {
  MocapTrack track;
  track.poses.push_back({1.25, {Eigen::Quaterniond(0, 0, 0, 1), {1, 2, 3}}});
  EXPECT_EQ(to_tum(track),
            "# t x y z qx qy qz qw, z up, seconds and metres\n"
            "1.250000 1.0000000 2.0000000 3.0000000 0.000000000 0.000000000 1.000000000 "
            "0.000000000\n");
}

}  // namespace
}  // namespace mixrig::mocap
