// SPDX-License-Identifier: Apache-2.0
// A camera tracker over the loopback: the sockets are real, the time is injected.
#include "extras/broadcast/poses/camera_stream.h"

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "extras/broadcast/packets/camera_angles.h"
#include "extras/broadcast/packets/freed.h"
#include "extras/broadcast/packets/opentrackio.h"
#include "extras/broadcast/poses/stamp_scale.h"
#include "host/output/datagrams/datagram_sender.h"
#include "tests/support/progress.h"
#include "tests/support/refusal.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/throw_in.h"
#include "tests/support/udp_listener.h"
#include "tests/unit/pose/swing.h"

namespace mixrig::pose {
namespace {

using capture::PoseLoss;

constexpr double kStart_s = 100, kOnTheWay_s = 0.03, kFrame_s = 0.04;

std::string free_port() { return test::UdpListener().address(); }

HostTime stream_host(double t_s) {
  return HostTime(Duration(std::llround(1e9 * (kStart_s + t_s))));
}

std::string_view text_of_bytes(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A tracker at 25 Hz whose camera swings; each packet comes kOnTheWay_s after its exposure.
class CameraStreamTest : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.address = free_port();
    options_.delay_s = kOnTheWay_s;
    options_.rate_hz = 1 / kFrame_s;
  }
  void open(bool freed) {
    freed_ = freed;
    auto poses =
        freed ? open_freed_poses(options_, clock_) : open_opentrack_poses(options_, clock_);
    ASSERT_TRUE(poses) << poses.error().context;
    poses_ = *std::move(poses);
    auto sender = stream::DatagramSender::open(options_.address);
    ASSERT_TRUE(sender);
    sender_.emplace(*std::move(sender));
  }
  void send(double t_s, const std::optional<geometry::Pose>& pose, bool saturated = false) {
    clock_.sleep_until(stream_host(t_s + kOnTheWay_s));
    if (freed_)
      send_freed(pose.value_or(geometry::Pose{}), saturated);
    else
      send_sample(t_s, pose);
    ++sent_;
    EXPECT_TRUE(test::comes_true(
        [&] { return poses_->stream()->packets + poses_->faults().packets_bad == sent_; }));
  }
  /// Sends a sample of OpenTrackIO at once.
  void send_at(Duration since_1970, const geometry::Pose& pose) {
    send_stamped(since_1970, pose);
    ++sent_;
    EXPECT_TRUE(test::comes_true([&] { return poses_->stream()->packets == sent_; }));
  }
  capture::CameraPose at(double t_s) {
    capture::Capture capture;
    capture.mid_exposure = stream_host(t_s);
    return poses_->pose_of(capture);
  }

  test::ThreadedClock clock_;
  CameraStreamOptions options_;
  std::unique_ptr<capture::PoseSource> poses_;
  std::optional<stream::DatagramSender> sender_;
  std::uint64_t sent_ = 0;

 private:
  void send_freed(const geometry::Pose& pose, bool saturated) {
    const auto angles = stream::camera_angles(pose.rotation);
    stream::FreeDPacket packet;
    packet.pan_rad = -angles.pan_rad, packet.tilt_rad = angles.tilt_rad;
    packet.roll_rad = angles.roll_rad;
    packet.position_m = pose.translation_m;
    if (saturated) packet.position_m.x() = 500;
    sender_->send(text_of_bytes(stream::freed_bytes(packet)));
  }
  void send_sample(double t_s, const std::optional<geometry::Pose>& pose) {
    send_stamped(Duration(1'750'000'000'000'000'000 + std::llround(1e9 * t_s)), pose);
  }
  void send_stamped(Duration since_1970, const std::optional<geometry::Pose>& pose) {
    stream::OpenTrackSample sample;
    sample.number = sent_;
    sample.time_ns = since_1970.count();
    if (pose) {
      sample.angles = stream::camera_angles(pose->rotation);
      sample.position_m = pose->translation_m;
    }
    const auto encoding =
        sent_ % 2 ? stream::OpenTrackEncoding::kCbor : stream::OpenTrackEncoding::kJson;
    const auto payload = stream::opentrack_payload(sample, encoding);
    for (const auto& datagram :
         stream::opentrack_datagrams(payload, encoding, static_cast<std::uint16_t>(sent_ + 65530)))
      sender_->send(text_of_bytes(datagram));
  }
  bool freed_ = true;
};

TEST_F(CameraStreamTest, WhatItsThreadThrowsIsLoggedAndNoPoseIsKnown) {
  const test::ThrowIn thrown("receiving");
  open(true);
  EXPECT_TRUE(test::comes_true([] {
    return test::logged("receiving: no memory is left: stop other programs: no more poses");
  }));
  EXPECT_FALSE(at(0).ok());
}

TEST_F(CameraStreamTest, GivesThePoseAtMidExposureFromBothProtocols) {
  for (const bool freed : {true, false}) {
    options_.address = free_port();
    sent_ = 0;
    open(freed);
    const double begin_s = freed ? 0 : 10;  // the clock only goes forward
    for (int i = 0; i < 50; ++i) send(begin_s + kFrame_s * i, swing(begin_s + kFrame_s * i));
    for (int i = 5; i < 40; ++i) {
      const double t_s = begin_s + kFrame_s * i;
      // At a sample: FreeD's units are 0.016 mm and 0.5 urad in each axis.
      const auto on = at(t_s);
      ASSERT_TRUE(on.ok());
      EXPECT_LT(distance(on.world_from_target, swing(t_s)).shift_m, 2e-5) << freed;
      EXPECT_LT(distance(on.world_from_target, swing(t_s)).turn_rad, 1e-6) << freed;
      // Between two samples: 4 m/s^2 over 40 ms leave an error of 0.8 mm.
      const auto between = at(t_s + 0.02);
      ASSERT_TRUE(between.ok());
      EXPECT_LT(distance(between.world_from_target, swing(t_s + 0.02)).shift_m, 0.0009);
      EXPECT_FALSE(on.covariance) << "none was stated";
    }
    EXPECT_EQ(poses_->info().name, freed ? "freed" : "opentrackio");
    EXPECT_EQ(at(begin_s + 2.15).loss, PoseLoss::kTooOld) << "silent for 0.19 s";
  }
}

TEST_F(CameraStreamTest, MovesFromTheTrackerToTheWorldAndFromItsCameraToOurs) {
  const Eigen::Quaterniond level(Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ()));
  options_.world_from_tracker = {level, {4, -1, 0.2}};
  options_.mount.body_from_target = {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized())),
      {0.1, -0.05, 0.3}};
  open(true);
  for (int i = 0; i < 10; ++i) send(kFrame_s * i, swing(kFrame_s * i));
  const geometry::Pose expected =
      options_.world_from_tracker * swing(0.2) * options_.mount.body_from_target;
  const auto pose = at(0.2);
  ASSERT_TRUE(pose.ok());
  EXPECT_LT(distance(pose.world_from_target, expected).shift_m, 2e-5);
  EXPECT_LT(distance(pose.world_from_target, expected).turn_rad, 1e-6);
}

TEST_F(CameraStreamTest, WhatIsSaturatedOrUnknownIsNoPose) {
  for (const bool freed : {true, false}) {
    options_.address = free_port();
    sent_ = 0;
    open(freed);
    const double begin_s = freed ? 0 : 10;
    for (int i = 0; i < 40; ++i) {
      const bool bad = i >= 10 && i < 20;
      send(begin_s + kFrame_s * i,
           bad && !freed ? std::nullopt : std::optional(swing(begin_s + kFrame_s * i)), bad);
    }
    EXPECT_EQ(poses_->faults().refused, 10U);
    EXPECT_EQ(at(begin_s + kFrame_s * 15).loss, PoseLoss::kGap) << freed;
    EXPECT_TRUE(at(begin_s + kFrame_s * 30).ok());
  }
}

TEST_F(CameraStreamTest, DamagedPacketsAreCountedAndLeaveNoTrace) {
  std::mt19937 random(8);
  for (const bool freed : {true, false}) {
    options_.address = free_port();
    sent_ = 0;
    open(freed);
    const double begin_s = freed ? 0 : 10;
    std::uint64_t bad = 0;
    for (int i = 0; i < 50; ++i) {
      if (i % 3 == 0) {
        std::string noise(random() % 200, '\0');
        for (char& c : noise) c = static_cast<char>(random());
        if (i % 2) noise = "OTrk" + noise;
        sender_->send(noise);
        ++bad, ++sent_;
      }
      send(begin_s + kFrame_s * i, swing(begin_s + kFrame_s * i));
    }
    EXPECT_EQ(poses_->faults().packets_bad, bad);
    EXPECT_EQ(poses_->faults().jumps, 0U);
    EXPECT_LT(distance(at(begin_s + 1).world_from_target, swing(begin_s + 1)).shift_m, 2e-5);
  }
}

TEST_F(CameraStreamTest, APortThatIsTakenAndAnAddressThatIsNoneAreOneLine) {
  const test::UdpListener other;
  options_.address = other.address();
  EXPECT_TRUE(test::refused(open_freed_poses(options_, clock_), {}, ErrorCode::kDevice));
  options_.address = "tracker:7000";
  EXPECT_EQ(open_freed_poses(options_, clock_).error().code, ErrorCode::kUsage);
  EXPECT_EQ(open_opentrack_poses(options_, clock_).error().code, ErrorCode::kUsage);
}

TEST(StampScale, IsThatWhichAgreesWithTheSystemClock) {
  using std::chrono::milliseconds, std::chrono::seconds;
  constexpr Duration kTai = seconds(37);
  const UtcTime now(seconds(1'780'000'000));
  struct Row {
    bool stated;
    Duration ahead;
    Duration off;  ///< that is taken off
    const char* says;
  };
  const Row rows[] = {
      {false, milliseconds(-20), Duration(0), ""},
      {false, milliseconds(500), Duration(0), ""},
      {false, kTai - milliseconds(20), kTai, "they are PTP's (TAI): 37 s are taken off"},
      {true, kTai - milliseconds(20), kTai, ""},
      {false, seconds(12), Duration(0), "12.0 s ahead of this machine's system time"},
      {false, seconds(-3600), Duration(0), "3600.0 s behind this machine's system time"},
      {true, milliseconds(-20), kTai, "37.0 s behind this machine's PTP time"},
  };
  for (const Row& row : rows) {
    testing::internal::CaptureStderr();
    StampScale scale(row.stated, kTai);
    const Duration stamp = now.time_since_epoch() + row.ahead;
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(scale.utc_of(stamp.count(), now), UtcTime(stamp - row.off));
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find(row.says), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), row.says[0] != 0) << said;
  }
}

/// The scene says "system", or "ptp": the camera is where it was at the stamp of PTP.
TEST_F(CameraStreamTest, StampsOfPtpAreTakenAsTai) {
  for (const auto stamps :
       {scene::TrackerStream::Stamps::kSystem, scene::TrackerStream::Stamps::kPtp}) {
    options_.address = free_port();
    options_.stamps = stamps, options_.delay_s = 0;
    constexpr Duration kStep = std::chrono::milliseconds(40);
    sent_ = 0;
    open(false);
    const HostTime begin = clock_.now();
    const Duration system(std::chrono::system_clock::now().time_since_epoch());
    for (int i = 0; i < 10; ++i) send_at(system + tai_minus_utc() + i * kStep, swing(0));
    // The injected clock stands while the system's goes on.
    capture::Capture capture;
    capture.mid_exposure = begin + 3 * kStep;
    const auto pose = poses_->pose_of(capture);
    ASSERT_TRUE(pose.ok()) << capture::name(pose.loss);
    EXPECT_LT(distance(pose.world_from_target, swing(0)).shift_m, 2e-5);
    capture.mid_exposure = begin + tai_minus_utc();
    EXPECT_EQ(poses_->pose_of(capture).loss, PoseLoss::kTooOld);
  }
}

TEST(CameraStream, TheStatedNoiseHasACovarianceThatHolds) {
  CameraStreamOptions options;
  options.noise = TrackerNoise{1e-3, 2e-3};
  options.world_from_tracker = {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ())), {4, -1, 0.2}};
  options.mount.body_from_target.translation_m = {0.1, -0.4, 0.7};
  const geometry::Pose camera = swing(0.7), truth = target_seen(camera, options).world_from_target;
  std::mt19937 random(2);
  std::normal_distribution<double> unit;
  constexpr int kSamples = 4000;
  double nees = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d turn =
        options.noise->turn_rad * Eigen::Vector3d(unit(random), unit(random), unit(random));
    const geometry::Pose noisy{
        Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * camera.rotation,
        camera.translation_m +
            options.noise->shift_m * Eigen::Vector3d(unit(random), unit(random), unit(random))};
    const TargetSeen seen = target_seen(noisy, options);
    const Eigen::AngleAxisd off(seen.world_from_target.rotation * truth.rotation.conjugate());
    Eigen::Matrix<double, 6, 1> error;
    error << off.angle() * off.axis(), seen.world_from_target.translation_m - truth.translation_m;
    nees += error.dot(seen.covariance->ldlt().solve(error)) / kSamples;
  }
  // Mean of chi-squared with 6 degrees of freedom; 4000 samples scatter by 0.055.
  EXPECT_NEAR(nees, 6, 0.25);
}

}  // namespace
}  // namespace mixrig::pose
