// SPDX-License-Identifier: Apache-2.0
// Poses that [[pose_out]] of one run sends are read by a pose source of another run: over sockets
// of this machine, with injected time.
#include <gtest/gtest.h>

#include "extras/broadcast/poses/camera_stream.h"
#include "extras/broadcast/poses/pose_sink.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/udp_listener.h"
#include "tests/unit/pose/swing.h"

namespace mixrig::session {
namespace {

using Protocol = scene::PoseOut::Protocol;

constexpr double kUnitTurn_rad = M_PI / 180 / 32768, kUnitShift_m = 1e-3 / 64;

HostTime loop_time(double t_s) { return HostTime(Duration(std::llround(1e9 * (50 + t_s)))); }

output::CompositePtr loop_frame(double t_s, bool lost) {
  auto capture = std::make_shared<capture::Capture>();
  capture->mid_exposure = loop_time(t_s);
  auto composite = std::make_shared<output::Composite>();
  composite->capture = capture;
  composite->world_from_target = pose::swing(t_s);
  if (lost) composite->pose = capture::CameraPose::lost(capture::PoseLoss::kGap);
  composite->view = {{640, 480}, 500, 500, 319.5, 239.5};
  return composite;
}

class PoseLoop : public ::testing::TestWithParam<Protocol> {};

TEST_P(PoseLoop, ThePoseThatWasSentIsThePoseThatIsUsed) {
  const bool freed = GetParam() == Protocol::kFreeD;
  constexpr double kFrame_s = 0.04, kDelay_s = 0.02;
  test::ThreadedClock clock;
  pose::CameraStreamOptions options;
  options.address = test::UdpListener().address() + ",7";
  options.delay_s = kDelay_s;
  options.rate_hz = 25;
  auto poses =
      freed ? pose::open_freed_poses(options, clock) : pose::open_opentrack_poses(options, clock);
  ASSERT_TRUE(poses) << poses.error().context;
  scene::PoseOut out;
  out.protocol = GetParam();
  out.udp = options.address.substr(0, options.address.find(','));
  out.camera = 7;
  std::vector<PoseOutReport> reports;
  const auto sink = PoseSink::create(
      {out}, [] { return 1'750'000'000'000'000'000; }, std::nullopt, reports);
  ASSERT_TRUE(sink) << sink.error().context;
  std::uint64_t sent = 0;
  for (int i = 0; i < 60; ++i) {
    const bool lost = i == 30;
    clock.sleep_until(loop_time(kFrame_s * i + kDelay_s));
    ASSERT_TRUE((*sink)->write(loop_frame(kFrame_s * i, lost)));
    sent += !(lost && freed);
    ASSERT_TRUE(test::comes_true([&] { return (*poses)->stream()->packets >= sent; }));
  }
  for (int i = 2; i < 60; ++i) {
    if (i == 30) continue;
    const auto capture = loop_frame(kFrame_s * i, false)->capture;
    const auto pose = (*poses)->pose_of(*capture);
    ASSERT_TRUE(pose.ok()) << i;
    const auto error = pose::distance(pose.world_from_target, pose::swing(kFrame_s * i));
    EXPECT_LE(error.shift_m, kUnitShift_m) << i;
    EXPECT_LE(error.turn_rad, std::sqrt(3) * kUnitTurn_rad) << i;
  }
  EXPECT_EQ((*poses)->faults().packets_bad, 0U);
  EXPECT_EQ((*poses)->faults().refused, freed ? 0U : 1U) << "the frame without a pose";
}

INSTANTIATE_TEST_SUITE_P(Protocols, PoseLoop,
                         ::testing::Values(Protocol::kFreeD, Protocol::kOpenTrackJson,
                                           Protocol::kOpenTrackCbor));

}  // namespace
}  // namespace mixrig::session
