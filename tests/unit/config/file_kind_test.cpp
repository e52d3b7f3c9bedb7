// SPDX-License-Identifier: Apache-2.0
#include "host/math/config/file_kind.h"

#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "host/math/config/table.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::config {
namespace {

TEST(FileKind, AFileOfAnotherKindIsNamedAndOneOfThisKindIsNot) {
  const std::set<std::string, std::less<>> scene{"camera", "background", "object"};
  const std::set<std::string, std::less<>> take{"format", "color", "depth"}, other{"keys"};
  const std::vector<std::string> of_take{"format", "color", "depth"}, of_scene{"camera", "object"};
  EXPECT_EQ(other_kind(of_take, scene), "this is the file of a take: name that of a scene");
  EXPECT_EQ(other_kind(of_scene, take), "this is the file of a scene: name that of a take");
  EXPECT_EQ(other_kind(of_take, take), "");
  EXPECT_EQ(other_kind(of_scene, scene), "");
  EXPECT_EQ(other_kind(of_take, other), "") << "a kind that is not known";
  EXPECT_EQ(other_kind(std::vector<std::string>{"cameras", "background"}, scene), "")
      << "a misspelt key in the right file";
  EXPECT_EQ(other_kind(std::vector<std::string>{"treshold"}, scene), "");
}

TEST(FileKind, ABinaryFileIsKnownByItsFirstBytes) {
  EXPECT_EQ(binary_kind("\x1A\x45\xDF\xA3 and more"),
            "a Matroska file: make a take of a recording by mixrig import");
  EXPECT_EQ(binary_kind("#ROSBAG V2.0\n"),
            "a ROS bag: make a take of a recording by mixrig import");
  EXPECT_EQ(binary_kind("NI10\x01"),
            "an .oni recording: name it as openni2:FILE in rig.toml and record it");
  EXPECT_EQ(binary_kind("\x89PNG\r\n"), "a PNG picture: give the right file");
  for (const char* const text : {"", "#ROS", "[camera]\n", "glTF", "NI = 1\n"})
    EXPECT_EQ(binary_kind(text), "") << text;
}

/// Files that are given in place of a take or a scene, also those that are larger than any text.
TEST(FileKind, AReaderOfTextNamesWhatItWasGiven) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.mkv";
  std::ofstream(file, std::ios::binary) << "\x1A\x45\xDF\xA3" << std::string(9000, '\0');
  for (const std::size_t most : {100U, 100'000U})
    EXPECT_EQ(read_text(file, most).error().context,
              "cannot read '" + file.string() +
                  "': it is a Matroska file: make a take of a recording by mixrig import");
}

}  // namespace
}  // namespace mixrig::config
