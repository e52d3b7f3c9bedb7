// SPDX-License-Identifier: Apache-2.0
// A motion capture as it comes over a network: another clock, delay, jitter, lost frames.
#include "host/pose/mocap/mocap_track.h"

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "host/pose/mocap/mocap_poses.h"
#include "tests/support/count_allocations.h"
#include "tests/support/progress.h"
#include "tests/unit/mocap/natnet_server.h"
#include "tests/unit/pose/swing.h"

namespace mixrig::pose {
namespace {

using capture::PoseLoss;
using stream::NatNetFrame;

constexpr double kRate_hz = 120, kDelay_s = 0.03, kDrift = 80e-6, kClock_s = 40;

HostTime host(double t_s) { return HostTime(Duration(std::llround((1000 + t_s) * 1e9))); }
double stamp_s(double t_s) { return kClock_s + (1 + kDrift) * t_s; }

/// The stream's world is that of the swing: z up.
NatNetFrame frame_at(int number) {
  NatNetFrame frame;
  frame.number = number;
  const double t_s = number / kRate_hz;
  frame.time_s = stamp_s(t_s);
  frame.bodies.push_back({3, swing(t_s), 0.0002, true});
  return frame;
}

MocapOptions options() {
  MocapOptions options;
  options.up = mocap::Up::kZ;
  options.delay_s = kDelay_s;
  return options;
}

/// Frames until `to_s` on their way; those that arrived before `now_s` are added.
class Network {
 public:
  Network(MocapTrack& track, double loss) : track_(track), loss_(loss) {}
  void deliver_until(double now_s) {
    while (next_ / kRate_hz + kDelay_s + jitter_s_ <= now_s) {
      if (share_(random_) >= loss_)
        track_.add(frame_at(next_), host(next_ / kRate_hz + kDelay_s + jitter_s_));
      ++next_;
      jitter_s_ = 0.002 * share_(random_);
    }
  }

 private:
  MocapTrack& track_;
  const double loss_;
  std::mt19937 random_{4};
  std::uniform_real_distribution<double> share_;
  int next_ = 0;
  double jitter_s_ = 0;
};

/// Worst distance to the truth over 20 s; a picture is composited `latency_s` after its exposure.
PoseDistance worst_error(double latency_s, double loss, int& lost) {
  MocapTrack track(options());
  Network network(track, loss);
  PoseDistance worst;
  for (int k = 0; k < 500; ++k) {
    const double t_s = 1 + k / 25.0;
    network.deliver_until(t_s + latency_s);
    const auto pose = track.at(host(t_s));
    lost += !pose.ok();
    if (!pose.ok()) continue;
    const auto error = distance(pose.world_from_target, swing(t_s));
    worst = {std::max(worst.turn_rad, error.turn_rad), std::max(worst.shift_m, error.shift_m)};
  }
  return worst;
}

TEST(MocapTrack, FollowsThroughDelayJitterDriftAndLoss) {
  int lost = 0;
  // Pictures that are composited after both frames around them came: interpolation. A frame may
  // be missing: 17 ms between samples at 4 m/s^2 leave 0.14 mm; the clock is known to 0.1 ms
  // (1.4 m/s: 0.14 mm).
  const auto known = worst_error(0.06, 0.02, lost);
  EXPECT_EQ(lost, 0);
  EXPECT_LT(known.shift_m, 0.0004);
  EXPECT_LT(known.turn_rad, 0.0004);
  // Composited 20 ms after exposure, the newest frame is 10 to 20 ms before it, one more with a
  // lost frame: a (h (h + T)) / 2 with h = 0.03, T = 0.04, a = 4 m/s^2.
  const auto predicted = worst_error(0.02, 0.02, lost);
  EXPECT_EQ(lost, 0);
  EXPECT_LT(predicted.shift_m, 0.0042);
  EXPECT_GT(predicted.shift_m, known.shift_m);
  RecordProperty("interpolated_um", static_cast<int>(1e6 * known.shift_m));
  RecordProperty("predicted_um", static_cast<int>(1e6 * predicted.shift_m));
}

TEST(MocapTrack, ADelayThatIsNotStatedCostsTheMotionDuringIt) {
  MocapOptions wrong = options();
  wrong.delay_s = 0;
  MocapTrack track(wrong);
  Network network(track, 0);
  network.deliver_until(3.08);
  const auto pose = track.at(host(3.04));
  ASSERT_TRUE(pose.ok());
  EXPECT_NEAR(distance(pose.world_from_target, swing(3.04 - kDelay_s)).shift_m, 0, 0.001);
  EXPECT_GT(distance(pose.world_from_target, swing(3.04)).shift_m, 0.02);
}

TEST(MocapTrack, SaysOnceWhyAFrameHasNoBody) {
  struct Row {
    std::vector<int> streamed;
    int wanted;
    const char* says;
  };
  const Row rows[] = {
      {{3}, 0, ""},
      {{3, 7}, 7, ""},
      {{3, 7}, 0, "several bodies are streamed (3, 7): name the camera's by camera.body"},
      {{2, 5, 11}, 0, "(2, 5, 11)"},
      {{3, 7}, 4, "camera.body is 4, but only others are streamed (3, 7)"},
      {{}, 0, "no body is streamed"},
      {{}, 4, "camera.constellation"},
  };
  for (const Row& row : rows) {
    MocapOptions wanted = options();
    wanted.body_id = row.wanted;
    MocapTrack track(wanted);
    testing::internal::CaptureStderr();
    for (int i = 0; i < 30; ++i) {
      NatNetFrame frame = frame_at(i);
      frame.bodies.clear();
      for (const int id : row.streamed) frame.bodies.push_back({id, swing(0), 0.0002, true});
      track.add(frame, host(i / kRate_hz + kDelay_s));
    }
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find(row.says), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), row.says[0] != 0) << said;
    EXPECT_EQ(track.at(host(0.2)).loss, row.says[0] != 0 ? PoseLoss::kNoSample : PoseLoss::kNone);
  }
}

TEST(MocapTrack, IsLostBeforeAfterAndInGaps) {
  MocapTrack track(options());
  EXPECT_EQ(track.at(host(0)).loss, PoseLoss::kNoSample);
  for (int i = 120; i < 240; ++i)
    if (i < 180 || i > 200) track.add(frame_at(i), host(i / kRate_hz + kDelay_s));
  EXPECT_EQ(track.at(host(0.9)).loss, PoseLoss::kOutside);
  EXPECT_EQ(track.at(host(1.6)).loss, PoseLoss::kGap);
  EXPECT_TRUE(track.at(host(1.8)).ok());
  const auto late = track.at(host(239 / kRate_hz + 0.06));
  ASSERT_TRUE(late.ok());
  EXPECT_NEAR(late.age_s, 0.06, 1e-3);
  EXPECT_EQ(track.at(host(239 / kRate_hz + 0.11)).loss, PoseLoss::kTooOld);
}

TEST(MocapTrack, WrongFramesAreCountedAndLeaveNoTrace) {
  MocapTrack track(options());
  for (int i = 0; i < 240; ++i) {
    NatNetFrame frame = frame_at(i);
    if (i == 100) frame.bodies[0].world_from_body.translation_m.x() += 1;
    if (i == 130) frame.bodies[0].world_from_body.translation_m.x() = NAN;
    if (i == 150) frame.bodies[0].tracked = false;
    if (i == 160) frame.bodies.clear();
    if (i == 170) frame.time_s = NAN;
    track.add(frame, host(i / kRate_hz + kDelay_s));
  }
  for (double t_s = 0.7; t_s < 1.6; t_s += 0.001) {
    const auto pose = track.at(host(t_s));
    ASSERT_TRUE(pose.ok()) << t_s;
    EXPECT_LT(distance(pose.world_from_target, swing(t_s)).shift_m, 0.0004) << t_s;
  }
  EXPECT_EQ(track.faults().jumps, 1U);
  EXPECT_EQ(track.faults().not_finite, 2U);
  EXPECT_EQ(track.faults().refused, 2U);
  EXPECT_EQ(track.faults().clock_steps, 0U);
}

TEST(MocapTrack, GoesOnAfterAClockThatStepped) {
  for (const double step_s : {-20.0, -0.2, 30.0}) {
    MocapTrack track(options());
    for (int i = 0; i < 480; ++i) {
      NatNetFrame frame = frame_at(i);
      if (i >= 240) frame.time_s += step_s;
      track.add(frame, host(i / kRate_hz + kDelay_s));
      const double now_s = i / kRate_hz;
      const auto pose = track.at(host(now_s));
      const bool settled = i < 240 || i > 250;
      if (settled) {
        EXPECT_TRUE(pose.ok()) << step_s << " " << i;
      }
      if (pose.ok()) {
        EXPECT_LT(distance(pose.world_from_target, swing(now_s)).shift_m, 0.002)
            << step_s << " " << i;
      }
    }
    EXPECT_EQ(track.faults().clock_steps, 1U) << step_s;
  }
}

TEST(MocapTrack, APoseOfAFrameAllocatesNothing) {
  MocapTrack track(options());
  for (int i = 0; i < 240; ++i) track.add(frame_at(i), host(i / kRate_hz + kDelay_s));
  const long before = test::allocations;
  EXPECT_TRUE(track.at(host(1.5)).ok());
  EXPECT_TRUE(track.at(host(2.01)).ok());
  EXPECT_EQ(test::allocations, before);
}

TEST(TargetSeen, FindsTheConstellationWithACovarianceThatHolds) {
  constexpr int kFrames = 2000;
  constexpr double kSigma_m = 0.0005;
  MocapOptions o = options();
  o.constellation = mocap::Constellation{
      "hat", kSigma_m, {{0, 0, 0}, {0.1, 0, 0}, {0, 0.17, 0}, {0.03, 0.05, 0.12}}};
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
  // The external calibration, off by 1 mrad and 1 mm more along some directions than others.
  calibration_file::CalibratedPose body{"body", {turn, {0.05, -0.2, 0.4}}, {}, 0, 0, {}};
  std::mt19937 random(2);
  std::normal_distribution<double> unit;
  Eigen::Matrix<double, 6, 6> root;
  for (double& element : root.reshaped()) element = 5e-4 * unit(random);
  body.covariance = root * root.transpose();
  const geometry::Pose world_from_body = swing(0.7);
  const geometry::Pose truth = world_from_body * geometry::inverse(body.target_from);
  std::normal_distribution<double> noise(0, kSigma_m);
  double nees = 0;
  for (int i = 0; i < kFrames; ++i) {
    calibration_file::CalibratedPose known = body;
    Eigen::Matrix<double, 6, 1> z;
    for (double& value : z) value = unit(random);
    const Eigen::Matrix<double, 6, 1> off = root * z;
    const Eigen::Vector3d w = off.head<3>();
    known.target_from.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(w.norm(), w.normalized())) * turn;
    known.target_from.translation_m += off.tail<3>();
    o.mount = mount_of(known);
    NatNetFrame frame;
    for (const auto& marker : o.constellation->markers_m)
      frame.markers.push_back(
          {0, 0,
           world_from_body * marker + Eigen::Vector3d(noise(random), noise(random), noise(random)),
           false, 0});
    const auto seen = target_seen(frame, o);
    ASSERT_TRUE(seen && seen->covariance);
    const Eigen::Matrix3d r =
        (seen->world_from_target.rotation * truth.rotation.conjugate()).matrix();
    Eigen::Matrix<double, 6, 1> error;
    error << 0.5 * (r(2, 1) - r(1, 2)), 0.5 * (r(0, 2) - r(2, 0)), 0.5 * (r(1, 0) - r(0, 1)),
        seen->world_from_target.translation_m - truth.translation_m;
    nees += error.dot(seen->covariance->ldlt().solve(error)) / kFrames;
  }
  // Mean of chi-squared with 6 degrees of freedom; 2000 samples scatter by 0.08.
  EXPECT_NEAR(nees, 6, 0.4);
}

TEST(TargetSeen, TurnsAWorldWithYUp) {
  MocapOptions o = options();
  o.up = mocap::Up::kY;
  NatNetFrame frame;
  frame.bodies.push_back({3, {Eigen::Quaterniond::Identity(), {1, 2, 3}}, 0, true});
  // y up becomes z up, z becomes -y.
  EXPECT_LT(
      (target_seen(frame, o)->world_from_target.translation_m - Eigen::Vector3d(1, -3, 2)).norm(),
      1e-12);
  frame.bodies.push_back({4, {}, 0, true});
  EXPECT_FALSE(target_seen(frame, o)) << "which of both?";
  o.body_id = 4;
  EXPECT_TRUE(target_seen(frame, o));
}

TEST(MocapPoses, AreReceivedOverTheLoopback) {
  std::vector<std::vector<std::byte>> packets;
  for (int i = 0; i < 300; ++i)
    if (i % 50 != 20)  // 2 % lost
      // Packets at the interval at which the server sends them.
      packets.push_back(stream::frame_with_body(i, 0.5F, 2e-4 * i, false).packet(7));
  packets[40].resize(30);
  stream::NatNetServer server(packets);
  SystemClock clock;
  MocapOptions o = options();
  o.delay_s = 0;
  o.most_ahead_s = 600;  // the pose stays, however late this test looks
  const auto poses = open_mocap_poses("127.0.0.1:" + std::to_string(server.port()), o, clock);
  ASSERT_TRUE(poses) << poses.error().context;
  capture::Capture capture;
  const bool came = test::comes_true([&] {
    capture.mid_exposure = clock.now() - std::chrono::milliseconds(20);
    return (*poses)->pose_of(capture).ok();
  });
  ASSERT_TRUE(came);
  EXPECT_NEAR((*poses)->pose_of(capture).world_from_target.translation_m.x(), 0.5, 1e-6);
  EXPECT_TRUE(test::comes_true([&] {
    const auto faults = (*poses)->faults();
    return faults.packets_lost == 7 && faults.packets_bad == 1;
  }));
}

TEST(MocapPoses, AnAddressThatIsNoneIsRefused) {
  SystemClock clock;
  const auto poses = open_mocap_poses("motive:port", options(), clock);
  ASSERT_FALSE(poses);
  EXPECT_EQ(poses.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace mixrig::pose
