// SPDX-License-Identifier: Apache-2.0
// The command on the whole rig with faults during a take, and the rig as a source of frames to
// composite.
#include <thread>

#include "host/capture/take/take.h"
#include "tests/board/rig_bench.h"
#include "tests/board/uvc_device.h"

namespace mixrig::board {
namespace {

/// Reads every frame of a take; returns their number.
int read_all(const std::string& folder) {
  auto take = take::TakeReader::open(folder);
  EXPECT_TRUE(take) << (take ? std::string() : to_line(take.error()));
  if (!take) return 0;
  capture::Capture frame;
  for (int number = 1; number <= take->info().frames; ++number)
    EXPECT_TRUE(take->read(number, frame)) << number;
  return take->info().frames;
}

TEST_F(Rig, AResetOfTheTriggerBoardInMidTakeIsNamedAndTheTakeIsWhole) {
  fs::remove_all("/tmp/reset");
  Ran ran;
  std::thread recording([&] {
    ran = run(std::string("mixrig record --format png --duration 6 --rig ") + kConfig + " --json " +
              kReport + " /tmp/reset");
  });
  EXPECT_TRUE(wait_until([] { return fs::exists("/tmp/reset.partial/color/000040.png"); }));
  rig_.trigger.reset();
  recording.join();
  ASSERT_EQ(ran.status, 0) << ran.text;
  const Json report = read_json(kReport);
  EXPECT_EQ(report["trigger_restarts"], 1);
  const int frames = read_all("/tmp/reset");
  EXPECT_EQ(report["frames"], frames);
  EXPECT_GE(frames, (6 - 2) * 25) << "back within two seconds";
  // Tick numbers restart once, and colour and depth always have the same one.
  const auto color = ticks_of("/tmp/reset", "color"), depth = ticks_of("/tmp/reset", "depth");
  EXPECT_EQ(color, depth);
  int restarts = 0;
  for (int number = 2; number <= frames; ++number)
    restarts += color.at(number) < color.at(number - 1);
  EXPECT_EQ(restarts, 1);
  measured("%d frames of 6 s with a reset of the trigger board", frames);
}

TEST_F(Rig, AFullDiskEndsTheTakeWhole) {
  fs::remove_all("/tmp/small");
  fs::create_directory("/tmp/small");
  ASSERT_EQ(run("mount -t tmpfs -o size=6m none /tmp/small").status, 0);
  const Ran ran = run(std::string("mixrig record --format png --keep-free 0 --duration 60 --rig ") +
                      kConfig + " /tmp/small/take");
  EXPECT_EQ(ran.status, 1) << ran.text;
  EXPECT_NE(ran.text.find("No space left on device"), std::string::npos) << ran.text;
  EXPECT_NE(ran.text.find("the take ends after"), std::string::npos) << ran.text;
  const int frames = read_all("/tmp/small/take");
  EXPECT_GE(frames, 1);
  measured("%d frames fit on the disk, all readable", frames);
  EXPECT_EQ(run("umount /tmp/small").status, 0);
}

TEST_F(Rig, IsComposited) {
  std::ofstream("/tmp/scene.toml")
      << "[camera]\npose = \"identity\"\n[background]\nlearn = [1, 5]\n";
  fs::remove_all("/tmp/out");
  const Ran ran = run(std::string("mixrig run /tmp/scene.toml --backend cpu --format png "
                                  "--frames 6-30 --out /tmp/out --source rig:") +
                      kConfig);
  ASSERT_EQ(ran.status, 0) << ran.text;
  const Json report = read_json("/tmp/out/report.json");
  EXPECT_EQ(report["frames"], 25);
  const auto& live = report["live"];
  // The streams are colour and depth: the scene uses neither the fisheye nor a second colour
  // camera.
  EXPECT_EQ(live["streams"].size(), 2U) << live["streams"];
  for (const char* count : {"ticks_lost", "trigger_errors", "pan_tilt_errors"})
    EXPECT_EQ(live[count], 0) << count;
  // The one emulated processor composites before it writes; frames that the writer is too slow for
  // are reported as dropped.
  const int written = read_all("/tmp/out/composite");
  const int left_out = report["sinks"][0]["dropped"];
  EXPECT_EQ(written + left_out, 25);
  EXPECT_GE(written, 20);
  measured("25 composites of %d sets, %d dropped; %d written", live["sets"].get<int>(),
           live["dropped_sets"].get<int>(), written);
}

}  // namespace
}  // namespace mixrig::board
