// SPDX-License-Identifier: Apache-2.0
#include "host/capture/open/open_source.h"

#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

live::RigConfig whole_rig() {
  live::RigConfig rig;
  for (const char* name : {"target", "fisheye"}) {
    rig.cameras.emplace_back();
    rig.cameras.back().name = name;
  }
  rig.depth.emplace();
  rig.pan_tilt_uri = "flir-ptu:/dev/ttyUSB0";
  rig.trigger_uri = "mcu:/dev/ttyACM0";
  rig.edges_uri = "gpiod:gpiochip0/17";
  return rig;
}

TEST(UsedBy, LeavesOutTheFisheye) {
  live::RigConfig rig = whole_rig();
  rig.depth->trigger_line = 1;
  const live::RigConfig used = used_by({}, rig);
  ASSERT_EQ(used.cameras.size(), 1U);
  EXPECT_EQ(used.cameras[0].name, "target");
  EXPECT_TRUE(used.depth);
  EXPECT_EQ(used.pan_tilt_uri, rig.pan_tilt_uri) << "a fixed pose watches it";
  EXPECT_EQ(used.trigger_uri, rig.trigger_uri) << "it fires the depth camera";
  EXPECT_EQ(used.edges_uri, rig.edges_uri);
}

TEST(UsedBy, TheTrackerNeedsTheFisheyeAndTheHeadOnlyToPredictByIt) {
  live::RigConfig rig = whole_rig();
  rig.cameras.emplace_back().name = "side";
  scene::Scene scene;
  scene.pose_source = scene::PoseSource::kTracker;
  const live::RigConfig used = used_by(scene, rig);
  ASSERT_EQ(used.cameras.size(), 2U);
  EXPECT_EQ(used.cameras[1].name, "fisheye");
  EXPECT_EQ(used.pan_tilt_uri, "");
  scene.camera.predict = scene::Predict::kHead;
  EXPECT_EQ(used_by(scene, rig).pan_tilt_uri, rig.pan_tilt_uri);
}

TEST(OpenRig, ATrackerWithoutItsFisheyeIsRefused) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("rig.toml",
                                 "format = 1\nname = \"r\"\n[[camera]]\nname = \"target\"\nuri = "
                                 "\"take:none/color\"\n[depth]\nuri = \"take:none/depth\"\n");
  scene::Scene scene;
  scene.pose_source = scene::PoseSource::kTracker;
  std::atomic<bool> stop = false;
  SystemClock clock;
  EXPECT_TRUE(
      test::refused(open_rig(file, scene, stop, clock), {"\"fisheye\""}, ErrorCode::kFormat));
}

TEST(UsedBy, LeavesOutAHeadThatThePoseDoesNotDependOn) {
  for (const auto source : {scene::PoseSource::kRecorded, scene::PoseSource::kMocap}) {
    scene::Scene scene;
    scene.pose_source = source;
    EXPECT_EQ(used_by(scene, whole_rig()).pan_tilt_uri, "");
  }
}

TEST(UsedBy, LeavesOutATriggerThatFiresOnlyOtherCameras) {
  live::RigConfig rig = whole_rig();
  rig.cameras[1].trigger_line = 2;
  const live::RigConfig used = used_by({}, rig);
  EXPECT_EQ(used.trigger_uri, "");
  EXPECT_EQ(used.edges_uri, "");
}

TEST(OpenRecordings, ARecordingThatCannotBeOpenedHoldsItsError) {
  live::RigConfig rig;
  rig.cameras.emplace_back();
  rig.cameras[0].uri = "take:/nonexistent/color";
  rig.depth.emplace();
  rig.depth->uri = "take:/nonexistent/depth";
  const auto recordings = open_recordings(rig);
  ASSERT_EQ(recordings.size(), 1U) << "one recording replaces both cameras";
  EXPECT_EQ(recordings[0].uri, "take:/nonexistent");
  EXPECT_FALSE(recordings[0].source);
}

TEST(OpenSource, ABareFolderIsATakeWhereNoKindOfSourceHasItsName) {
  const test::TemporaryFolder folder;
  const std::string uri = folder.path().string();
  const auto as_take = open_source(uri);
  ASSERT_FALSE(as_take);
  EXPECT_NE(as_take.error().context.find("take.toml"), std::string::npos);
  const auto refuse = [](const std::string&) -> Result<std::unique_ptr<capture::CaptureSource>> {
    return Error{ErrorCode::kData, "by its kind"};
  };
  const auto by_kind = open_source(uri, {.sources = {{uri, "KIND", refuse}}, .devices = {}});
  ASSERT_FALSE(by_kind);
  EXPECT_EQ(by_kind.error().context, "by its kind");
}

TEST(OpenSource, ARigIsNoRecording) {
  EXPECT_TRUE(test::refused(open_source("rig:none.toml"), {}, ErrorCode::kUsage));
}

}  // namespace
}  // namespace mixrig::session
