// SPDX-License-Identifier: Apache-2.0
// The list of takes: what is in a folder of recordings, and what is noted about them.
#include "host/operator/desk/take_list.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

constexpr const char* kNote =
    "name = \"1-1 take 1\"\nnotes = \"first\"\nframes = 60.0\nlost = 1.0\n"
    "seconds = 2.0\nended = \"stopped\"\nlater_key = 3\n";

TEST(TakeList, HoldsWholeOnesAndWhatWasCutOff) {
  const test::TemporaryFolder folder;
  const TakeList none(folder.path() / "nothing");
  EXPECT_TRUE(none.takes({}).empty());
  EXPECT_FALSE(none.minutes_left({}, 100.0));
  TakeList list(folder.path());
  folder.write("1-1 take 1/recording.toml", kNote);
  folder.write("1-1 take 1/composite/color.mkv", std::string(4'000'000, 'x'));
  folder.write("1-1 take 2.partial/composite/color.mkv", std::string(500'000, 'x'));
  folder.write("of somebody else/notes.txt", "no recording");
  const auto takes = list.takes({});
  ASSERT_EQ(takes.size(), 2U);
  EXPECT_EQ(takes[0].name, "1-1 take 1");
  EXPECT_EQ(takes[0].frames, 60U);
  EXPECT_EQ(takes[0].state, "whole");
  EXPECT_NEAR(takes[0].megabytes, 4, 0.001);
  EXPECT_EQ(takes[1].state, "cut off");
  EXPECT_NEAR(*list.minutes_left({}, 1.0), 1000 / (4.0 / 2) / 60, 0.01) << "2 MB a second";
  page::RecordingState running;
  running.on = true, running.name = "1-1 take 2", running.seconds = 4;
  EXPECT_EQ(list.takes(running).size(), 1U) << "it is being written";
  EXPECT_NEAR(*list.minutes_left(running, 1.0), 1000 / (0.5 / 4) / 60, 0.01);
}

TEST(TakeList, NotesAndCirclesAreInRecordingToml) {
  const test::TemporaryFolder folder;
  TakeList list(folder.path());
  folder.write("a/recording.toml", kNote);
  ASSERT_TRUE(list.apply({.name = "a", .circled = true, .notes = "said \"good\"\nwind"}));
  const auto take = list.takes({}).at(0);
  EXPECT_TRUE(take.circled);
  EXPECT_EQ(take.notes, "said \"good\"\nwind");
  EXPECT_EQ(take.seconds, 2);
  EXPECT_NE(test::read_bytes(folder.path() / "a/recording.toml").find("later_key = 3"),
            std::string::npos);
  ASSERT_TRUE(list.apply({.name = "a", .circled = false}));
  EXPECT_FALSE(list.takes({}).at(0).circled);
  EXPECT_EQ(list.apply({.name = "b", .circled = true}).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mixrig::session
