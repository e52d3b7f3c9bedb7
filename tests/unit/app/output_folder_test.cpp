// SPDX-License-Identifier: Apache-2.0
#include "host/app/output_folder.h"

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

namespace mixrig::app {
namespace {
namespace fs = std::filesystem;

class OutputFolderTest : public ::testing::Test {
 protected:
  OutputFolderTest() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-out-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
  }
  ~OutputFolderTest() override { fs::remove_all(root_); }
  static void touch(const fs::path& path) { std::ofstream(path) << "x"; }
  fs::path root_;
};

TEST_F(OutputFolderTest, AppearsWholeAtFinish) {
  auto folder = OutputFolder::create(root_ / "a" / "b", "report.json");
  ASSERT_TRUE(folder) << folder.error().context;
  touch(folder->staging() / "picture");
  EXPECT_FALSE(fs::exists(root_ / "a" / "b"));
  ASSERT_TRUE(folder->finish());
  EXPECT_TRUE(fs::exists(root_ / "a" / "b" / "picture"));
  EXPECT_FALSE(fs::exists(root_ / "a" / "b.partial"));
}

TEST_F(OutputFolderTest, LeavesNothingWhenDropped) {
  {
    auto folder = OutputFolder::create(root_ / "out", "report.json");
    ASSERT_TRUE(folder);
    touch(folder->staging() / "picture");
    const OutputFolder moved = *std::move(folder);
  }
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(OutputFolderTest, ReplacesItsOwnFolder) {
  fs::create_directory(root_ / "out");
  touch(root_ / "out" / "report.json");
  touch(root_ / "out" / "stale");
  auto folder = OutputFolder::create((root_ / "out").string() + "/", "report.json");
  ASSERT_TRUE(folder);
  ASSERT_TRUE(folder->finish());
  EXPECT_TRUE(fs::is_empty(root_ / "out"));
  EXPECT_FALSE(fs::exists(root_ / "out.old"));
}

TEST_F(OutputFolderTest, RefusesAFileAndAFolderOfOthers) {
  touch(root_ / "file");
  fs::create_directory(root_ / "theirs");
  touch(root_ / "theirs" / "thesis.tex");
  for (const char* name : {"file", "theirs"}) {
    const auto folder = OutputFolder::create(root_ / name, "report.json");
    ASSERT_FALSE(folder);
    EXPECT_EQ(folder.error().code, ErrorCode::kUsage);
    EXPECT_FALSE(fs::exists(root_ / (std::string(name) + ".partial")));
  }
  EXPECT_TRUE(fs::exists(root_ / "theirs" / "thesis.tex"));
}

TEST_F(OutputFolderTest, TextThatCannotBeWrittenLeavesNothing) {
  const auto result = write_text(root_ / "missing" / "report.json", "{}");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kIo);
  ASSERT_TRUE(write_text(root_ / "report.json", "{}"));
  EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);
}

}  // namespace
}  // namespace mixrig::app
