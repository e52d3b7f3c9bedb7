// SPDX-License-Identifier: Apache-2.0
// The recording mocap-natnet through files, as `mixrig track --mocap` reads it.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "host/math/estimation/verdict.h"
#include "host/pose/mocap/live.h"
#include "host/pose/mocap/marker_file.h"
#include "host/pose/mocap/track.h"
#include "tests/unit/mocap/natnet_server.h"

namespace mixrig::mocap {
namespace {

namespace fs = std::filesystem;

/// The constellation of the recording (its rigid_body_definition.json).
Constellation race_quad() {
  return {"RaceQuad",
          0.001,
          {{-0.1611589938402176, 0.03505159914493561, -0.03218130022287369},
           {0.0308190006762743, 0.03978189826011658, -0.021990099921822548},
           {-0.1875309944152832, -0.03338329866528511, 0.1480810046195984},
           {0.0748715028166771, 6.686070264549926e-05, 0.03292329981923103},
           {0.05803820118308067, -0.03194189816713333, -0.13680699467658997}}};
}

TEST(MocapRecording, MarkersGiveThePosesThatTheSystemGives) {
  const char* root = std::getenv("MIXRIG_DATA");
  if (root == nullptr || !fs::exists(fs::path(root) / "mocap-natnet"))
    GTEST_SKIP() << "needs the recording mocap-natnet: set MIXRIG_DATA to the folder that holds it";
  const fs::path folder = fs::path(root) / "mocap-natnet";
  const auto markers = read_mocap_csv(folder / "markers.csv");
  const auto bodies = read_mocap_csv(folder / "rigid_body.csv");
  ASSERT_TRUE(markers) << markers.error().context;
  ASSERT_TRUE(bodies) << bodies.error().context;
  TrackOptions options;
  options.body_id = 2;
  const auto ours = track_markers(*markers, race_quad(), options);
  const auto theirs = track_bodies(*bodies, options);
  ASSERT_TRUE(theirs) << theirs.error().context;
  ASSERT_GT(ours.poses.size(), 200u);
  ASSERT_EQ(ours.poses.size(), theirs->poses.size());
  EXPECT_NEAR(ours.residual_rms_m, 0.00067, 0.00002);
  for (std::size_t i = 0; i < ours.poses.size(); ++i) {
    EXPECT_NEAR(ours.poses[i].time_s, theirs->poses[i].time_s, 1e-6);
    const auto error =
        estimation::pose_error(ours.poses[i].world_from_camera, theirs->poses[i].world_from_camera);
    EXPECT_LT(error.head<3>().norm(), 0.03 * M_PI / 180);
    EXPECT_LT(error.tail<3>().norm(), 0.0003);
  }
}

/// A server sends the markers of the file: the result must be that of the file, without the frames
/// that the network has lost.
TEST(MocapRecording, ComesOverTheNetAsFromTheFile) {
  const char* root = std::getenv("MIXRIG_DATA");
  if (root == nullptr || !fs::exists(fs::path(root) / "mocap-natnet"))
    GTEST_SKIP() << "needs the recording mocap-natnet: set MIXRIG_DATA to the folder that holds it";
  const auto file = read_mocap_csv(fs::path(root) / "mocap-natnet" / "markers.csv");
  ASSERT_TRUE(file) << file.error().context;
  constexpr std::size_t kLostEvery = 50;
  std::vector<stream::NatNetFrame> sent;
  std::vector<std::vector<std::byte>> packets;
  for (std::size_t i = 0; i < file->size(); ++i) {
    if (i % kLostEvery == 10) continue;
    sent.push_back((*file)[i]);
    packets.push_back(stream::packet_of_markers(sent.back()));
  }
  const stream::NatNetServer server(packets);
  const SystemClock clock;
  auto receiver = stream::NatNetReceiver::open(
      *stream::parse_natnet_address("natnet:127.0.0.1:" + std::to_string(server.port())), {3, 0},
      clock);
  ASSERT_TRUE(receiver) << receiver.error().context;
  const std::atomic<bool> stop = false;
  const auto received =
      receive_frames(*receiver, {.duration_s = {}, .frames = sent.size()}, stop, clock);
  ASSERT_TRUE(received) << received.error().context;
  ASSERT_EQ(received->size(), sent.size());
  EXPECT_EQ(receiver->counts().lost, static_cast<long>(file->size() - sent.size()));
  const auto live = track_markers(*received, race_quad(), {}),
             filed = track_markers(sent, race_quad(), {});
  std::printf("live: %zu of %zu frames, %ld lost, markers %.3f mm RMS from the body\n",
              live.poses.size(), received->size(), receiver->counts().lost,
              1e3 * live.residual_rms_m);
  EXPECT_NEAR(live.residual_rms_m, 0.00067, 0.00002);
  ASSERT_EQ(live.poses.size(), filed.poses.size());
  for (std::size_t i = 0; i < live.poses.size(); ++i)
    EXPECT_LT(
        estimation::pose_error(live.poses[i].world_from_camera, filed.poses[i].world_from_camera)
            .norm(),
        1e-5)
        << "single precision on the wire";
}

}  // namespace
}  // namespace mixrig::mocap
