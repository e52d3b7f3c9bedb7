// SPDX-License-Identifier: Apache-2.0
// Poses of composites as other programs get them, over sockets of this machine.
#include "extras/broadcast/poses/pose_sink.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "extras/broadcast/packets/freed.h"
#include "tests/support/refusal.h"
#include "tests/support/udp_listener.h"

namespace mixrig::session {
namespace {

using Protocol = scene::PoseOut::Protocol;
using Json = nlohmann::json;

constexpr std::int64_t kEpoch_ns = 1'750'000'000'000'000'000;
const EpochReader kEpoch = [] { return kEpoch_ns; };

/// A camera at (1, 2, 1.5) m that looks 30 degrees to the right of +y, at 4.8 s.
std::shared_ptr<output::Composite> frame() {
  auto capture = std::make_shared<capture::Capture>();
  capture->mid_exposure = HostTime(std::chrono::milliseconds(4800));
  capture->encoders = geometry::LensEncoders{4012, 70000};
  auto composite = std::make_shared<output::Composite>();
  composite->capture = capture;
  composite->world_from_target =
      geometry::look_at({1, 2, 1.5}, {1 + 0.5, 2 + std::sqrt(0.75), 1.5}, Eigen::Vector3d::UnitZ());
  composite->view = {{640, 480}, 500, 400, 329.5, 239.5};
  return composite;
}

Json sample_in(const std::string& datagram) {
  return datagram.size() < 16 ? Json() : Json::parse(datagram.substr(16));
}

class PoseSinkTest : public ::testing::Test {
 protected:
  std::unique_ptr<PoseSink> sink_of(std::vector<scene::PoseOut> outs) {
    auto sink = PoseSink::create(outs, kEpoch, std::nullopt, reports_);
    EXPECT_TRUE(sink) << sink.error().context;
    return sink ? *std::move(sink) : nullptr;
  }
  test::UdpListener listener_;
  std::vector<PoseOutReport> reports_;
};

TEST_F(PoseSinkTest, FreeDHasItsSignsAndTheEncoders) {
  const auto sink = sink_of({{Protocol::kFreeD, listener_.address(), 7}});
  ASSERT_TRUE(sink->write(frame()));
  const std::string datagram = listener_.awaited();
  const auto packet = stream::parse_freed(std::as_bytes(std::span(datagram)));
  ASSERT_TRUE(packet) << packet.error().context;
  EXPECT_EQ(packet->camera, 7);
  EXPECT_NEAR(packet->pan_rad, M_PI / 6, 1e-6) << "to the right";
  EXPECT_NEAR(packet->tilt_rad, 0, 1e-6);
  EXPECT_NEAR((packet->position_m - Eigen::Vector3d(1, 2, 1.5)).norm(), 0, 2e-5);
  EXPECT_EQ(packet->zoom, 4012U);
  EXPECT_EQ(packet->focus, 70000U);
}

TEST_F(PoseSinkTest, OpenTrackIOHasTimeAndLensOfThePicture) {
  const auto sink = sink_of({{Protocol::kOpenTrackJson, listener_.address(), 2, 32}});
  ASSERT_TRUE(sink->write(frame()));
  const Json sample = sample_in(listener_.awaited());
  EXPECT_EQ(sample["sourceNumber"], 2);
  EXPECT_EQ(sample["timing"]["sampleTimestamp"]["seconds"], 1'750'000'004);
  EXPECT_EQ(sample["timing"]["sampleTimestamp"]["nanoseconds"], 800'000'000);
  EXPECT_NEAR(sample["transforms"][0]["rotation"]["pan"].get<double>(), -30, 1e-6) << "to the left";
  // 500 px of 640 are 25 of 32 mm; the principal point is 10 px to the right of the middle.
  EXPECT_NEAR(sample["lens"]["pinholeFocalLength"].get<double>(), 25, 1e-9);
  EXPECT_NEAR(sample["lens"]["projectionOffset"]["x"].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(sample["lens"]["projectionOffset"]["y"].get<double>(), 0, 1e-9);
  // 400 px of 480: 25 mm of 30 mm.
  EXPECT_NEAR(sample["static"]["camera"]["activeSensorPhysicalDimensions"]["height"].get<double>(),
              30, 1e-9);
  ASSERT_TRUE(sink->write(frame()));
  const Json second = sample_in(listener_.awaited());
  EXPECT_FALSE(second.contains("static")) << "sent every two seconds";
  EXPECT_NE(second["sampleId"], sample["sampleId"]);
  EXPECT_EQ(second["sourceId"], sample["sourceId"]);
}

TEST_F(PoseSinkTest, OpenTrackIOSaysWhatSetsTheClock) {
  using ClockSource = scene::PoseOut::ClockSource;
  const auto told = [&](ClockSource clock, bool (*is_locked)()) {
    scene::PoseOut out{Protocol::kOpenTrackJson, listener_.address()};
    out.clock = clock;
    const auto sink = PoseSink::create({out}, kEpoch, std::nullopt, reports_, is_locked);
    EXPECT_TRUE(sink && (*sink)->write(frame()));
    return sample_in(listener_.awaited())["timing"].value("synchronization", Json());
  };
  EXPECT_EQ(told(ClockSource::kPtp, [] { return true; }),
            Json::parse(R"({"source":"ptp","locked":true})"));
  EXPECT_EQ(told(ClockSource::kNtp, [] { return false; }),
            Json::parse(R"({"source":"ntp","locked":false})"));
  EXPECT_TRUE(told(ClockSource::kNotTold, [] { return true; }).is_null()) << "it is not known";
}

/// PTP counts TAI, which has been 37 s ahead of UTC since 2017.
TEST_F(PoseSinkTest, WhatIsSentAsPtpIsTai) {
  using ClockSource = scene::PoseOut::ClockSource;
  const auto seconds_as = [&](ClockSource clock) {
    scene::PoseOut out{Protocol::kOpenTrackJson, listener_.address()};
    out.clock = clock;
    EXPECT_TRUE(sink_of({out})->write(frame()));
    return sample_in(listener_.awaited())["timing"]["sampleTimestamp"]["seconds"].get<int>();
  };
  EXPECT_EQ(seconds_as(ClockSource::kNtp), 1'750'000'004);
  EXPECT_EQ(seconds_as(ClockSource::kNotTold), 1'750'000'004);
  EXPECT_EQ(seconds_as(ClockSource::kPtp), 1'750'000'004 + seconds(tai_minus_utc()));
  EXPECT_GE(tai_minus_utc(), std::chrono::seconds(37));
}

TEST_F(PoseSinkTest, ARecordingBeginsWhenTheRunDoes) {
  const auto sink = PoseSink::create({{Protocol::kOpenTrackJson, listener_.address()}}, kEpoch,
                                     HostTime(std::chrono::seconds(100)), reports_);
  ASSERT_TRUE(sink) << sink.error().context;
  for (const int frame_ms : {0, 40}) {
    const auto composite = frame();
    auto capture = std::make_shared<capture::Capture>(*composite->capture);
    capture->mid_exposure += std::chrono::milliseconds(frame_ms);
    composite->capture = capture;
    ASSERT_TRUE((*sink)->write(composite));
    const Json time = sample_in(listener_.awaited())["timing"]["sampleTimestamp"];
    EXPECT_EQ(time["seconds"], 1'750'000'100);
    EXPECT_EQ(time["nanoseconds"], frame_ms * 1'000'000);
  }
}

TEST_F(PoseSinkTest, StampsFollowTheSystemTimeThatIsSetMeanwhile) {
  std::int64_t epoch_ns = kEpoch_ns;
  const auto sink = PoseSink::create(
      {{Protocol::kOpenTrackJson, listener_.address()}}, [&] { return epoch_ns; }, std::nullopt,
      reports_);
  ASSERT_TRUE(sink) << sink.error().context;
  for (const std::int64_t step_s : {0, 3600}) {
    epoch_ns = kEpoch_ns + step_s * 1'000'000'000;
    const auto composite = frame();
    auto capture = std::make_shared<capture::Capture>(*composite->capture);
    capture->mid_exposure += std::chrono::seconds(step_s > 0 ? 2 : 0);
    composite->capture = capture;
    ASSERT_TRUE((*sink)->write(composite));
    EXPECT_EQ(sample_in(listener_.awaited())["timing"]["sampleTimestamp"]["seconds"],
              1'750'000'004 + step_s + (step_s > 0 ? 2 : 0));
  }
}

TEST_F(PoseSinkTest, ALostPoseIsToldOrNotSent) {
  test::UdpListener other;
  const auto sink = sink_of(
      {{Protocol::kFreeD, listener_.address()}, {Protocol::kOpenTrackJson, other.address()}});
  auto lost = frame();
  lost->pose = capture::CameraPose::lost(capture::PoseLoss::kGap);
  ASSERT_TRUE(sink->write(lost));
  const Json sample = sample_in(other.awaited());
  EXPECT_TRUE(listener_.next().empty());
  EXPECT_EQ(sample["tracker"]["status"], "lost: gap");
  EXPECT_FALSE(sample.contains("transforms"));
  ASSERT_TRUE(sink->finish());
  EXPECT_EQ(reports_[0].lost_frames, 1U);
  EXPECT_EQ(reports_[0].datagrams, 0U);
  EXPECT_EQ(reports_[1].datagrams, 1U);
}

TEST_F(PoseSinkTest, ReceiversThatAreNotThereDoNotMatter) {
  std::string gone;
  { gone = test::UdpListener().address(); }
  const auto sink = sink_of({{Protocol::kFreeD, gone}});
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(sink->write(frame()));
  ASSERT_TRUE(sink->finish());
  EXPECT_GT(reports_[0].dropped, 0U);
}

TEST_F(PoseSinkTest, AnAddressThatIsNoneIsRefused) {
  const auto sink =
      PoseSink::create({{Protocol::kFreeD, "nowhere:1"}}, kEpoch, std::nullopt, reports_);
  EXPECT_TRUE(test::refused(sink, {}, ErrorCode::kUsage));
  EXPECT_TRUE(sink.error().context.starts_with("pose_out.udp: \"nowhere:1\" is no address"))
      << sink.error().context;
}

}  // namespace
}  // namespace mixrig::session
