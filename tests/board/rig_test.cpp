// SPDX-License-Identifier: Apache-2.0
// The command on the whole rig: rig init; diag without faults and with one fault at a time; and a
// take in which every frame is checked to belong to its tick.
#include <cstdlib>
#include <set>

#include "host/capture/live/rig/rig_config.h"
#include "host/capture/take/take.h"
#include "tests/board/rig_bench.h"

namespace mixrig::board {
namespace {

using Names = std::set<std::string>;

TEST_F(Rig, InitFindsEveryDevice) {
  const Ran ran = run("mixrig rig init /tmp/found.toml --force");
  ASSERT_EQ(ran.status, 0) << ran.text;
  const auto found = live::read_rig("/tmp/found.toml");
  ASSERT_TRUE(found) << to_line(found.error());
  Names uris;
  for (const auto& camera : found->cameras) uris.insert(camera.uri);
  EXPECT_EQ(uris,
            (Names{"v4l2:/dev/video0", "v4l2:" + rig_.color_node, "aravis:Aravis-Fake-GV01"}));
  ASSERT_TRUE(found->depth);
  EXPECT_EQ(found->depth->uri, "usb:1209:0001");
  EXPECT_EQ(found->trigger_uri, "mcu:/dev/ttyACM0");
  EXPECT_EQ(found->pan_tilt_uri, "flir-ptu:/dev/ttyACM1");
}

TEST_F(Rig, DiagPassesEveryDevice) {
  const auto verdicts = diag();
  EXPECT_EQ(devices(verdicts, "fail"), Names{});
  Names passed = devices(verdicts, "pass");
  for (const std::string& name : devices(verdicts, "warn"))
    if (name != "host") passed.erase(name);  // the guest's disk is small
  passed.erase("host");
  EXPECT_EQ(passed,
            (Names{"trigger", "trigger_edges", "color", "side", "mono", "depth", "pan_tilt"}));
}

TEST_F(Rig, DiagNamesTheDeviceThatIsMissing) {
  rig_.color_port.unplug();
  EXPECT_EQ(devices(diag("--no-move"), "fail"), Names{"color"});
  ASSERT_TRUE(rig_.plug_color());
  rig_.depth_port.unplug();
  EXPECT_EQ(devices(diag("--no-move"), "fail"), Names{"depth"});
  ASSERT_TRUE(rig_.plug_depth());
  rig_.head_port.unplug();
  EXPECT_EQ(devices(diag("--no-move"), "fail"), Names{"pan_tilt"});
  ASSERT_TRUE(rig_.plug_head());
  gige_.reset();
  EXPECT_EQ(devices(diag("--no-move"), "fail"), Names{"mono"});
}

TEST_F(Rig, DiagNamesTheTriggerThatIsMissingAndTheCamerasThatWaitForIt) {
  rig_.trigger_port.unplug();
  EXPECT_EQ(devices(diag("--no-move"), "fail"), (Names{"trigger", "color", "depth"}));
}

TEST_F(Rig, DiagNamesTheDeviceThatIsFaulty) {
  rig_.head.set_faults({.silent = true});
  EXPECT_EQ(devices(diag("--no-move"), "fail"), Names{"pan_tilt"});
  rig_.head.set_faults({.stalled = true});
  auto verdicts = diag();
  EXPECT_EQ(devices(verdicts, "fail"), Names{"pan_tilt"});
  EXPECT_EQ(verdicts["pan_tilt/repeatability"], "fail");
  rig_.head.set_faults({});
  rig_.depth.fail_every(10, TofFault::kLosePacket);
  verdicts = diag("--no-move");
  EXPECT_EQ(devices(verdicts, "fail"), Names{"depth"});
  EXPECT_EQ(verdicts["depth/lost"], "fail");
  rig_.depth.fail_every(0, TofFault::kNone);
  rig_.color.miss_every(5);
  verdicts = diag("--no-move");
  EXPECT_EQ(devices(verdicts, "fail"), Names{"color"});
}

TEST_F(Rig, EveryFrameOfATakeBelongsToItsTick) {
  const char* duration = std::getenv("MIXRIG_BOARD_RECORD_S");
  const int duration_s = duration != nullptr ? std::atoi(duration) : 10;
  fs::remove_all("/tmp/take");
  const Ran ran =
      run(std::string("mixrig record --format png --duration ") + std::to_string(duration_s) +
          " --rig " + kConfig + " --json " + kReport + " /tmp/take");
  ASSERT_EQ(ran.status, 0) << ran.text;
  const Json report = read_json(kReport);
  const int frames = report["frames"];
  EXPECT_GE(frames, duration_s * 25 - 2);
  // The colour camera may be paired one frame before the ToF camera; within the take no frame is
  // missing.
  EXPECT_LE(report["left_out"].get<int>(), 1);
  EXPECT_EQ(report["dropped_sets"], 0);
  for (const auto& stream : report["streams"])
    measured("%s: %d frames, %d lost, residual %.2f +- %.2f ms, drift %.0f ppm",
             stream["name"].get<std::string>().c_str(), stream["frames"].get<int>(),
             stream["lost"].get<int>(), stream["residual_mean_ms"].get<double>(),
             stream["residual_sd_ms"].get<double>(), stream["drift_ppm"].get<double>());

  const auto& edges = report["edges"];
  EXPECT_GE(edges["seen"].get<int>(), frames);
  EXPECT_EQ(edges["lost"].get<int>() + edges["doubled"].get<int>(), 0);
  EXPECT_LT(std::abs(edges["offset_mean_ms"].get<double>()), 5) << "another tick";
  measured("%d edges of the colour camera's line, %+.3f +- %.3f ms from the master's tick",
           edges["seen"].get<int>(), edges["offset_mean_ms"].get<double>(),
           edges["offset_sd_ms"].get<double>());
  measured("%d answers of the head, %d sets without its angle",
           report["pan_tilt_samples"].get<int>(), report["sets_without_angle"].get<int>());
  EXPECT_EQ(report["sets_without_angle"], 0);

  const auto color = ticks_of("/tmp/take", "color"), depth = ticks_of("/tmp/take", "depth");
  ASSERT_EQ(static_cast<int>(color.size()), frames);
  ASSERT_EQ(static_cast<int>(depth.size()), frames);
  measured("it begins with tick %llu, %d sets before it were left out",
           static_cast<unsigned long long>(color.at(1)), report["left_out"].get<int>());
  EXPECT_LE(color.at(1), 4U * kDivider);
  auto take = take::TakeReader::open("/tmp/take");
  ASSERT_TRUE(take) << to_line(take.error());
  capture::Capture frame;
  std::set<long>
      ties;  // camera's own number minus tick: one value for all, or a frame is mispaired
  int steps = 0;
  for (int number = 1; number <= frames; ++number) {
    ASSERT_TRUE(take->read(number, frame));
    const long seen_by_color = read_code(frame.plate) % kTofCodes;
    const long seen_by_depth = std::lround(frame.depth_m.row(0)[0] * 1000) - kTofCodeBase_steps;
    for (const long tie : {seen_by_color - static_cast<long>(color.at(number)),
                           seen_by_depth - static_cast<long>(depth.at(number))})
      ties.insert((tie % kTofCodes + kTofCodes) % kTofCodes);
    EXPECT_EQ(color.at(number), depth.at(number));
    if (number > 1) steps += color.at(number) - color.at(number - 1) == kDivider;
  }
  EXPECT_EQ(ties.size(), 1U);
  EXPECT_EQ(steps, frames - 1) << "ticks without a frame";
  const Ran info = run("mixrig info /tmp/take");
  EXPECT_EQ(info.status, 0) << info.text;
  measured("%d frames of %d s, each colour and depth frame on the tick that fired it", frames,
           duration_s);
}

}  // namespace
}  // namespace mixrig::board
