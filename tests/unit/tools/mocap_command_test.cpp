// SPDX-License-Identifier: Apache-2.0
// calibrate external, then track --mocap with the files of the former.
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "host/capture/calibration_file/calibration.h"
#include "host/math/estimation/verdict.h"
#include "tests/unit/mocap/natnet_server.h"
#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

const Pose kBody{estimation::rotation_exp({0.2, -0.7, 0.4}), {1.2, 1.5, -0.3}};
const Pose kCamera{estimation::rotation_exp({-0.1, 0.15, 1.4}), {0.06, -0.04, 0.11}};
const Vector3d kMarkers[] = {
    {0.02, 0.1, 0}, {-0.08, 0.03, 0.02}, {0.05, -0.11, 0.01}, {0.01, 0.02, 0.09}};

std::string line_of(const char* key, const Vector3d& p) {
  char line[160];
  std::snprintf(line, sizeof line, "%s = [%.9f, %.9f, %.9f]\n", key, p.x(), p.y(), p.z());
  return line;
}

/// The camera is the target camera itself, in front of five markers, without noise.
std::string external() {
  std::string text =
      "[camera]\nname = \"target\"\nsize_px = [512, 424]\nfocal_px = [365, 365]\n"
      "centre_px = [255, 211]\n[noise]\nrange_m = 0.004\nmarker_m = 0.0003\n";
  const Vector3d seen[] = {
      {-0.5, 0.3, 1.4}, {0.4, 0.35, 1.2}, {0.1, -0.4, 1.8}, {-0.2, -0.1, 1.1}, {0.5, -0.2, 1.6}};
  for (const Vector3d& p : seen) {
    char pixel[160];
    std::snprintf(pixel, sizeof pixel, "pixel_px = [%.9f, %.9f]\ndepth_m = %.9f\n",
                  365 * p.x() / p.z() + 255, 365 * p.y() / p.z() + 211, p.z());
    text += "[[marker]]\n" + line_of("world_m", kBody * kCamera * p) + pixel;
  }
  for (const Vector3d& p : kMarkers)
    text += "[[body_marker]]\n" + line_of("position_m", p) + "[[body_seen]]\n" +
            line_of("world_m", kBody * p);
  return text;
}

std::string constellation() {
  std::string text = "sigma_m = 0.0003\n";
  for (const Vector3d& p : kMarkers) text += "[[marker]]\n" + line_of("position_m", p);
  return text;
}

/// Two frames of the body's markers as CSV.
std::string recording() {
  std::string text = "frame,t_s,x_m,y_m,z_m\n";
  for (int frame = 0; frame < 2; ++frame)
    for (const Vector3d& p : kMarkers) {
      const Vector3d at = kBody * p;
      char line[160];
      std::snprintf(line, sizeof line, "%d,%.3f,%.9f,%.9f,%.9f\n", frame, 0.5 * frame, at.x(),
                    at.y(), at.z());
      text += line;
    }
  return text;
}

std::vector<Pose> read_tum(const std::string& text) {
  std::vector<Pose> poses;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    double t = 0;
    Vector3d p;
    Eigen::Vector4d q;
    if (std::sscanf(line.c_str(), "%lf %lf %lf %lf %lf %lf %lf %lf", &t, &p.x(), &p.y(), &p.z(),
                    &q.x(), &q.y(), &q.z(), &q.w()) == 8)
      poses.push_back({Eigen::Quaterniond(q), p});
  }
  return poses;
}

TEST(MocapCommands, TheExternalCalibrationMakesCameraPosesOfBodyPoses) {
  const TinyTake take;
  take.text("external.toml", external());
  take.text("body.toml", constellation());
  take.text("walk.csv", recording());
  const Outcome made =
      take.mixrig("calibrate external external.toml --calibration cal.toml --json external.json");
  ASSERT_EQ(made.status, 0) << made.err;
  const auto report = nlohmann::json::parse(take.text_of("external.json"));
  EXPECT_NEAR(report["camera_in_body_m"][2].get<double>(), 0.11, 1e-5);
  EXPECT_FALSE(report["rotation_xyzw"].is_null());
  const Outcome tracked = take.mixrig(
      "track --mocap walk.csv --constellation body.toml --calibration cal.toml --up z t.tum");
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  EXPECT_NE(tracked.out.find("2 of 2 frames"), std::string::npos) << tracked.out;
  const auto poses = read_tum(take.text_of("t.tum"));
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_LT(estimation::pose_error(poses[1], kBody * kCamera).norm(), 1e-5);
}

TEST(MocapCommands, TrackFollowsALiveStream) {
  const TinyTake take;
  take.text("body.toml", constellation());
  std::vector<std::vector<std::byte>> packets;
  for (const int number : {10, 11, 14, 15}) {
    stream::NatNetFrame frame{number, number / 100.0, {}, {}};
    for (const Vector3d& p : kMarkers)
      frame.markers.push_back({0, static_cast<int>(frame.markers.size()), kBody * p, false, 0});
    packets.push_back(stream::packet_of_markers(frame));
  }
  const stream::NatNetServer server(packets);
  const Outcome outcome =
      take.mixrig("track --mocap natnet:127.0.0.1:" + std::to_string(server.port()) +
                  " --constellation body.toml --up z t.tum --json t.json --frames 4");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::json::parse(take.text_of("t.json"));
  EXPECT_EQ(report["poses"], 4);
  EXPECT_EQ(report["live"]["lost"], 2);
  EXPECT_NE(outcome.out.find("2 lost"), std::string::npos) << outcome.out;
  const auto poses = read_tum(take.text_of("t.tum"));
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_LT(estimation::pose_error(poses[3], kBody).norm(), 1e-4);
}

TEST(MocapCommands, ReportTheFileAndTheReasonInOneLine) {
  const TinyTake take;
  take.text("external.toml", external());
  take.text("body.toml", constellation());
  take.text("walk.csv", recording());
  take.text("broken.csv", "frame,t_s,x_m,y_m,z_m\n1,2,3\n");
  take.text("packets.bin", "nothing of the kind");
  take.text("bodyless.toml", "format = 1\n");
  take.text("square.toml",
            "[[marker]]\nposition_m = [0, 0, 0]\n[[marker]]\nposition_m = [1, 0, 0]\n"
            "[[marker]]\nposition_m = [1, 1, 0]\n[[marker]]\nposition_m = [0, 1, 0]\n");
  const auto before = take.contents();
  struct Mistake {
    const char* words;
    int status;
    const char* says;
  };
  for (const Mistake& row :
       {Mistake{"track", 2, "--mocap"}, Mistake{"track --mocap no.csv", 2, "no.csv"},
        Mistake{"track --mocap broken.csv", 2, "broken.csv:2"},
        Mistake{"track --mocap walk.csv", 1, "--constellation"},
        Mistake{"track --mocap packets.bin", 2, "packet 1"},
        Mistake{"track --mocap packets.bin --natnet 2.9", 2, "--natnet"},
        Mistake{"track --mocap natnet:127.0.0.1:99999", 2, "natnet:HOST"},
        Mistake{"track --mocap natnet:no.such.host.invalid", 2, "no.such.host.invalid"},
        Mistake{"track --mocap walk.csv --constellation body.toml --calibration bodyless.toml", 1,
                "holds no pose of the body"},
        Mistake{"track --mocap walk.csv --constellation square.toml", 1, "turned"},
        Mistake{"track --mocap walk.csv --constellation body.toml --calibration no.toml", 2,
                "no.toml"},
        Mistake{"calibrate external no.toml", 2, "no.toml"},
        Mistake{"calibrate external body.toml", 2, "body.toml:3"}}) {
    const Outcome outcome =
        take.mixrig(std::string(row.words) + (row.words[0] == 't' ? " bad.tum" : ""));
    EXPECT_EQ(outcome.status, row.status) << row.words << ": " << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << row.words << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(row.says), std::string::npos) << row.words << ": " << outcome.err;
  }
  EXPECT_EQ(take.contents(), before);
  take.edit("external.toml", "name = \"target\"", "name = \"tof\"");
  const Outcome tof = take.mixrig("calibrate external external.toml --calibration cal.toml");
  EXPECT_NE(tof.status, 0);
  EXPECT_FALSE(fs::exists(take.path("cal.toml"))) << "nothing is half-written";
}

}  // namespace
}  // namespace mixrig::test
