// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/rig_config.h"

#include <gtest/gtest.h>

#include "host/capture/live/rig/depth_phases.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;

constexpr const char* kWhole = R"(
format = 1
name = "bench"
[trigger]
uri = "mcu:/dev/ttyACM0"
[[trigger.line]]
line = 0
divider = 4
width_ms = 2.0
[[trigger.line]]
line = 2
divider = 10
phase_ms = 20
active_low = true
[trigger.edges]
uri = "gpiod:gpiochip0/17"
line = 2
[[camera]]
name = "color"
uri = "aravis:Cam-1"
size_px = [1280, 1024]
format = "bayer_rggb8"
trigger_line = 0
delay_ms = 3.5
exposure_ms = 5
[[camera]]
uri = "v4l2:/dev/video0"
rate_hz = 30
[depth]
uri = "usb:1209:0001"
[pan_tilt]
uri = "flir-ptu:/dev/ttyUSB0@38400"
[target]
size_px = [1280, 1024]
fx = 1100.0
fy = 1101.0
cx = 639.5
cy = 511.5
distortion = [0.1, -0.2, 0.0, 0.0]
)";

/// Two depth cameras on lines of their own; the second one's line has the phase.
std::string two_depth_cameras(const std::string& phase_ms, const std::string& exposures = {}) {
  return R"(
format = 1
[trigger]
uri = "mcu:/dev/ttyACM0"
[[trigger.line]]
line = 0
divider = 4
[[trigger.line]]
line = 1
divider = 4
phase_ms = )" +
         phase_ms + R"(
[[depth]]
uri = "aravis:left"
trigger_line = 0
)" + exposures +
         R"(
[[depth]]
uri = "aravis:right"
trigger_line = 1
unit_m = 0.0005
)" + exposures +
         R"(
[tof2]
size_px = [640, 480]
fx = 500.0
fy = 500.0
cx = 319.5
cy = 239.5
)";
}

TEST(RigConfig, HoldsTwoDepthCameras) {
  const auto rig = parse_rig(two_depth_cameras("20", "exposure_ms = 16"), "rig.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  ASSERT_TRUE(rig->depth && rig->depth2);
  EXPECT_EQ(rig->depth->name, "depth");
  EXPECT_EQ(rig->depth2->name, "depth2");
  EXPECT_EQ(rig->depth2->uri, "aravis:right");
  EXPECT_EQ(rig->depth2_steps.unit_m, 0.0005);
  EXPECT_FALSE(rig->depth_steps.unit_m);
  ASSERT_TRUE(rig->tof2);
  EXPECT_EQ(rig->tof2->pinhole.fx_px, 500);
  const DepthPhases phases = depth_phases(*rig);
  EXPECT_TRUE(phases.known);
  EXPECT_FALSE(phases.overlap);
  EXPECT_EQ(phases.apart, 20ms);
  const auto again = parse_rig(rig_text(*rig), "again.toml");
  ASSERT_TRUE(again) << to_line(again.error());
  ASSERT_TRUE(again->depth2);
  EXPECT_EQ(again->depth2->trigger_line, 1);
  EXPECT_EQ(again->depth2_steps.unit_m, 0.0005);
  EXPECT_EQ(again->depth->uri, "aravis:left");
}

TEST(RigConfig, DepthCamerasThatExposeAtTheSameTimeAreRefused) {
  for (const auto& [phase_ms, exposures] :
       {std::pair("0", ""), std::pair("40", ""), std::pair("15.9", "exposure_ms = 16"),
        std::pair("24.1", "exposure_ms = 16")}) {
    const auto rig = parse_rig(two_depth_cameras(phase_ms, exposures), "rig.toml");
    ASSERT_FALSE(rig) << phase_ms;
    EXPECT_NE(to_line(rig.error()).find("expose at the same time"), std::string::npos)
        << to_line(rig.error());
  }
  for (const char* phase_ms : {"16", "24", "136"})
    EXPECT_TRUE(parse_rig(two_depth_cameras(phase_ms, "exposure_ms = 16"), "rig.toml")) << phase_ms;
}

TEST(RigConfig, ItSaysWhereItCannotTellWhetherDepthCamerasExposeAtTheSameTime) {
  const auto apart = parse_rig(two_depth_cameras("20"), "rig.toml");
  ASSERT_TRUE(apart) << to_line(apart.error());
  EXPECT_FALSE(depth_phases(*apart).known);
  EXPECT_NE(depth_phases(*apart).line.find("exposure_ms"), std::string::npos);
  const auto free =
      parse_rig("format = 1\n[[depth]]\nuri = \"v4l2:a\"\n[[depth]]\nuri = \"v4l2:b\"\n", "r");
  ASSERT_TRUE(free) << to_line(free.error());
  EXPECT_FALSE(depth_phases(*free).known);
  EXPECT_NE(depth_phases(*free).line.find("runs free"), std::string::npos);
}

/// Periods of 30 and 40 ms come at all multiples of 10 ms apart.
TEST(RigConfig, DepthCamerasOfDifferentRatesMeetAtAllMultiplesOfTheCommonPeriod) {
  std::string text = two_depth_cameras("5", "exposure_ms = 4");
  text.replace(text.find("divider = 4"), 11, "divider = 3");
  EXPECT_TRUE(parse_rig(text, "rig.toml"));
  text = two_depth_cameras("5", "exposure_ms = 6");
  text.replace(text.find("divider = 4"), 11, "divider = 3");
  EXPECT_FALSE(parse_rig(text, "rig.toml"));
}

TEST(RigConfig, AThirdDepthCameraIsRefused) {
  std::string text = "format = 1\n";
  for (int i = 0; i < 3; ++i) text += "[[depth]]\nuri = \"v4l2:a\"\n";
  const auto rig = parse_rig(text, "rig.toml");
  ASSERT_FALSE(rig);
  EXPECT_NE(to_line(rig.error()).find("at most two"), std::string::npos) << to_line(rig.error());
}

TEST(RigConfig, HoldsTheEncodersOfALens) {
  const std::string with = "format = 1\n[lens]\nuri = \"freed:0.0.0.0:6301,2\"\ndelay_ms = 12.5\n";
  const auto rig = parse_rig(with, "rig.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  EXPECT_EQ(rig->lens_uri, "freed:0.0.0.0:6301,2");
  EXPECT_EQ(rig->lens_delay, Duration(12500us));
  const auto again = parse_rig(rig_text(*rig), "again.toml");
  ASSERT_TRUE(again) << to_line(again.error());
  EXPECT_EQ(again->lens_uri, rig->lens_uri);
  EXPECT_EQ(again->lens_delay, rig->lens_delay);
}

TEST(RigConfig, ReadsEveryDevice) {
  const auto rig = parse_rig(kWhole, "rig.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  EXPECT_EQ(rig->trigger_uri, "mcu:/dev/ttyACM0");
  ASSERT_EQ(rig->lines.size(), 2U);
  EXPECT_EQ(rig->lines[0].channel.width, 2ms);
  EXPECT_EQ(rig->lines[1].channel.phase, 20ms);
  EXPECT_TRUE(rig->lines[1].channel.active_low);
  EXPECT_EQ(rig->edges_uri, "gpiod:gpiochip0/17");
  EXPECT_EQ(rig->line(rig->edges_line), &rig->lines[1]);
  ASSERT_EQ(rig->cameras.size(), 2U);
  EXPECT_EQ(rig->cameras[0].request.format, device::PixelFormat::kBayerRggb8);
  EXPECT_TRUE(rig->cameras[0].request.hardware_trigger);
  EXPECT_EQ(rig->cameras[0].delay, 3500us);
  EXPECT_DOUBLE_EQ(*rig->cameras[0].exposure_s, 0.005);
  EXPECT_EQ(rig->line_of(rig->cameras[0]), &rig->lines[0]);
  EXPECT_EQ(rig->cameras[1].name, "camera2");
  EXPECT_EQ(rig->line_of(rig->cameras[1]), nullptr);
  ASSERT_TRUE(rig->depth);
  EXPECT_EQ(rig->depth->uri, "usb:1209:0001");
  ASSERT_TRUE(rig->target);
  EXPECT_DOUBLE_EQ(rig->target->lens.coefficients()[1], -0.2);
}

TEST(RigConfig, ATriggerMayBeStartedByAnotherProgram) {
  const auto rig = parse_rig(
      "format = 1\n[trigger.edges]\nuri = \"gpiod:x/1\"\nline = 0\n"
      "[[trigger.line]]\nline = 0\ndivider = 4\n",
      "rig.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  EXPECT_TRUE(rig->trigger_uri.empty());
  EXPECT_EQ(parse_rig(rig_text(*rig), "again.toml")->edges_line, 0);
}

TEST(RigConfig, PosesAreReadAndMustBeRotations) {
  const std::string head = "format = 1\n[world_from_target]\ntranslation_m = [1.0, 2.0, 3.0]\n";
  const auto rig = parse_rig(
      head + "rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]\n", "rig.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  ASSERT_TRUE(rig->world_from_target);
  EXPECT_FALSE(rig->target_from_tof);
  const Eigen::Vector3d moved = rig->world_from_target->rotation * Eigen::Vector3d::UnitX() +
                                rig->world_from_target->translation_m;
  EXPECT_NEAR((moved - Eigen::Vector3d(1, 3, 3)).norm(), 0, 1e-12);
  const auto sheared = parse_rig(
      head + "rotation = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n", "rig.toml");
  ASSERT_FALSE(sheared);
  EXPECT_NE(sheared.error().context.find("rotation"), std::string::npos);
}

TEST(RigConfig, WhatIsWrittenReadsBackTheSame) {
  auto rig = parse_rig(kWhole, "rig.toml");
  ASSERT_TRUE(rig);
  EXPECT_FALSE(rig->play_at);
  rig->play_at = HostTime(1234567ms);
  const auto again = parse_rig(rig_text(*rig), "again.toml");
  ASSERT_TRUE(again) << to_line(again.error());
  EXPECT_EQ(rig_text(*again), rig_text(*rig));
  EXPECT_EQ(again->play_at, rig->play_at);
  EXPECT_EQ(again->cameras[0].delay, rig->cameras[0].delay);
  EXPECT_EQ(again->lines[1].channel.phase, rig->lines[1].channel.phase);
}

TEST(RigConfig, TextOfAnyKindIsReadBack) {
  RigConfig rig;
  for (const char* text : {"\"quoted\"", "back\\slash", "two\nlines", "B\xc3\xbchne", "[x]"}) {
    rig.name = text;
    rig.pan_tilt_uri = text;
    rig.cameras.resize(1);
    rig.cameras[0].name = rig.cameras[0].uri = text;
    const auto again = parse_rig(rig_text(rig), "again.toml");
    ASSERT_TRUE(again) << to_line(again.error()) << "\n" << rig_text(rig);
    EXPECT_EQ(again->name, text);
    EXPECT_EQ(again->pan_tilt_uri, text);
    EXPECT_EQ(again->cameras[0].name, text);
    EXPECT_EQ(again->cameras[0].uri, text);
  }
}

constexpr const char* kTold = R"(
format = 1
[[camera]]
uri = "v4l2:/dev/video0"
transfer = "gamma"
gamma = 1.8
yuv = "bt709"
range = "full"
black_level = 16
white_gains = [1.75, 1.0, 2.5]
[depth]
uri = "v4l2:/dev/video2"
unit_m = 0.00025
offset_m = -0.0125
kind = "distance"
unknown = [0, 65535]
noise = [0.001, 0.002, 0.003]
least_confidence = 40
light = true
[[trigger.line]]
line = 0
divider = 4
[trigger]
uri = "mcu:x"
)";

TEST(RigConfig, WhatSamplesAndStepsMeanIsReadAndReadsBack) {
  const auto first = parse_rig(kTold, "rig.toml");
  ASSERT_TRUE(first) << to_line(first.error());
  const auto rig = parse_rig(rig_text(*first), "again.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  const ColorConfig& color = rig->cameras[0].color;
  EXPECT_EQ(color.transfer, device::Transfer::kGamma);
  EXPECT_EQ(color.gamma, 1.8);
  EXPECT_EQ(color.matrix, device::YuvMatrix::kBt709);
  EXPECT_EQ(color.range, device::SampleRange::kFull);
  EXPECT_EQ(color.black_level, 16);
  EXPECT_EQ(color.white_gains, (std::array<double, 3>{1.75, 1, 2.5}));
  device::DepthInfo told{.metres_per_step = 1, .unit_known = false};
  told.intrinsics = device::DeviceIntrinsics{500, 1, 2};
  const device::DepthInfo depth = rig->depth_steps.applied_to(told);
  EXPECT_EQ(depth.metres_per_step, 0.00025);
  EXPECT_TRUE(depth.unit_known);
  EXPECT_EQ(depth.offset_m, -0.0125);
  EXPECT_EQ(depth.meaning, device::DepthMeaning::kDistance);
  EXPECT_EQ(depth.unknown_steps, (std::vector<int>{0, 65535}));
  EXPECT_EQ(depth.least_confidence, 40);
  EXPECT_TRUE(depth.amplitude_is_light);
  EXPECT_EQ(depth.intrinsics->focal_px, 500);
  EXPECT_EQ(rig->depth_steps.noise->quadratic_per_m, 0.003);
}

TEST(RigConfig, WhatItLeavesOutIsAsTheDeviceTellsIt) {
  const auto rig = parse_rig("format = 1\n[depth]\nuri = \"usb:1:2\"\n", "rig.toml");
  ASSERT_TRUE(rig);
  const device::DepthInfo told{.metres_per_step = 0.5,
                               .unit_known = false,
                               .offset_m = 3,
                               .unknown_steps = {7},
                               .least_confidence = 9,
                               .amplitude_is_light = true,
                               .meaning = device::DepthMeaning::kDistance};
  const device::DepthInfo depth = rig->depth_steps.applied_to(told);
  EXPECT_EQ(depth.metres_per_step, 0.5);
  EXPECT_FALSE(depth.unit_known);
  EXPECT_EQ(depth.offset_m, 3);
  EXPECT_EQ(depth.unknown_steps, told.unknown_steps);
  EXPECT_EQ(depth.least_confidence, 9);
  EXPECT_TRUE(depth.amplitude_is_light);
  EXPECT_EQ(depth.meaning, device::DepthMeaning::kDistance);
}

TEST(RigConfig, FaultsAreReportedWithFileAndKey) {
  struct Case {
    const char* text;
    const char* in_the_line;
  };
  const Case cases[] = {
      {"name = \"x\"", "format"},
      {"format = 2", "format"},
      {"format = 1\n[[camera]]\nname = \"a\"", "uri"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\nsize_px = [0, 5]", "size_px"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\nrate = 5", "rate"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\ntrigger_line = 3",
       "no [[trigger.line]] has line = 3"},
      {"format = 1\n[[camera]]\nname=\"a\"\nuri = \"v4l2:x\"\n[[camera]]\nname=\"a\"\nuri = "
       "\"v4l2:y\"",
       "two devices are named"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\nformat = \"yuv9\"", "format"},
      {"format = 1\n[trigger]\nuri = \"mcu:x\"\n[trigger.edges]\nuri = \"gpiod:x/1\"\nline = 3",
       "no [[trigger.line]] has line = 3"},
      {"format = 1\n[[trigger.line]]\nline = 0\ndivider = 4", "uri"},
      {"format = 1\n[depth]\nuri = \"usb:x\"\nunit_m = 0", "unit_m"},
      {"format = 1\n[depth]\nuri = \"usb:x\"\nunit_mm = 1", "unit_mm"},
      {"format = 1\n[depth]\nuri = \"usb:x\"\nkind = \"range\"", "kind"},
      {"format = 1\n[depth]\nuri = \"usb:x\"\nunknown = 65536", "unknown"},
      {"format = 1\n[depth]\nuri = \"usb:x\"\nunknown = [0.5]", "unknown"},
      {"format = 1\n[depth]\nuri = \"usb:x\"\ntransfer = \"linear\"", "transfer"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\ntransfer = \"gamma\"", "gamma"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\ngamma = 2.2", "gamma"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\nwhite_gains = [0.5, 1.0, 1.0]", "white_gains"},
      {"format = 1\n[[camera]]\nuri = \"v4l2:x\"\nunit_m = 0.001", "unit_m"},
      {"format = 1\n[trigger]\nuri = \"mcu:x\"\n[[trigger.line]]\nline = 0\ndivider = 0",
       "divider"},
  };
  for (const Case& c : cases) {
    const auto rig = parse_rig(c.text, "bad.toml");
    ASSERT_FALSE(rig) << c.text;
    EXPECT_EQ(rig.error().code, ErrorCode::kFormat);
    EXPECT_NE(rig.error().context.find("bad.toml"), std::string::npos) << rig.error().context;
    EXPECT_NE(rig.error().context.find(c.in_the_line), std::string::npos) << rig.error().context;
  }
}

}  // namespace
}  // namespace mixrig::live
