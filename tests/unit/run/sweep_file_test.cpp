// SPDX-License-Identifier: Apache-2.0
// A sweep is continued only with what it was begun with.
#include "host/room/sweep/sweep_file.h"

#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

SweepIdentity made_identity() { return {"aa", "bb", {270, 180}, 0.1, 4, {0.5, -0.25, 1, 0}}; }

TEST(SweepFile, TheSameSweepGoesOn) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(check_sweep_folder(folder / "s", made_identity()));
  ASSERT_TRUE(begin_or_resume(folder / "s", made_identity()));
  EXPECT_TRUE(std::filesystem::exists(folder / "s/sweep.toml"));
  EXPECT_TRUE(begin_or_resume(folder / "s", made_identity()));
  SweepIdentity before_devices = made_identity();
  before_devices.views_rad.clear();
  EXPECT_TRUE(check_sweep_folder(folder / "s", before_devices));
}

TEST(SweepFile, AnotherOneIsRefusedByTheKeyThatDiffers) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(begin_or_resume(folder / "s", made_identity()));
  const auto refused = [&](const char* key, auto change) {
    SweepIdentity other = made_identity();
    change(other);
    const auto begun = begin_or_resume(folder / "s", other);
    EXPECT_TRUE(test::refused(begun, {}, ErrorCode::kUsage)) << key;
    EXPECT_NE(begun.error().context.find("another " + std::string(key)), std::string::npos)
        << begun.error().context;
  };
  refused("rig", [](SweepIdentity& i) { i.rig = "cc"; });
  refused("calibration", [](SweepIdentity& i) { i.calibration = "cc"; });
  refused("field_deg", [](SweepIdentity& i) { i.field_deg.width = 360; });
  refused("overlap", [](SweepIdentity& i) { i.overlap = 0.2; });
  refused("view_frames", [](SweepIdentity& i) { i.view_frames = 5; });
  refused("plan of views", [](SweepIdentity& i) { i.views_rad[2] = 1.5; });
  refused("plan of views", [](SweepIdentity& i) { i.views_rad.resize(2); });
}

TEST(SweepFile, AFolderWithSomethingElseIsLeftAlone) {
  const test::TemporaryFolder folder;
  (void)folder.write("s/mine.txt", "x");
  EXPECT_TRUE(test::refused(begin_or_resume(folder / "s", made_identity()), {}, ErrorCode::kUsage));
  (void)folder.write("file", "x");
  EXPECT_FALSE(begin_or_resume(folder / "file", made_identity()));
  EXPECT_EQ(test::read_bytes(folder / "s/mine.txt"), "x");
}

}  // namespace
}  // namespace mixrig::session
