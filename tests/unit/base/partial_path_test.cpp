// SPDX-License-Identifier: Apache-2.0
#include "hal/base/partial_path.h"

#include <cstdlib>
#include <fstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/output_folder.h"

namespace mixrig {
namespace {
namespace fs = std::filesystem;

class PartialPathTest : public ::testing::Test {
 protected:
  PartialPathTest() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-out-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
  }
  ~PartialPathTest() override { fs::remove_all(root_); }
  static void touch(const fs::path& path) { std::ofstream(path) << "x"; }
  fs::path root_;
};

TEST_F(PartialPathTest, AppearsWholeAtFinish) {
  auto folder = make_partial_folder(root_ / "a" / "b", "report.json");
  ASSERT_TRUE(folder) << folder.error().context;
  touch(folder->path() / "picture");
  EXPECT_FALSE(fs::exists(root_ / "a" / "b"));
  ASSERT_TRUE(folder->commit());
  EXPECT_TRUE(fs::exists(root_ / "a" / "b" / "picture"));
  EXPECT_FALSE(fs::exists(root_ / "a" / "b.partial"));
}

TEST_F(PartialPathTest, LeavesNothingWhenDropped) {
  {
    auto folder = make_partial_folder(root_ / "out", "report.json");
    ASSERT_TRUE(folder);
    touch(folder->path() / "picture");
    const PartialPath moved = *std::move(folder);
  }
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(PartialPathTest, ReplacesItsOwnFolder) {
  fs::create_directory(root_ / "out");
  touch(root_ / "out" / "stale");
  touch(root_ / "out" / "report.json");
  auto folder = make_partial_folder((root_ / "out").string() + "/", "report.json");
  ASSERT_TRUE(folder);
  ASSERT_TRUE(folder->commit());
  EXPECT_TRUE(fs::is_empty(root_ / "out"));
  EXPECT_FALSE(fs::exists(root_ / "out.replaced"));
}

TEST_F(PartialPathTest, KeepsWhatSomebodyAddedToItsFolder) {
  fs::create_directories(root_ / "out" / "matte");
  touch(root_ / "out" / "report.json");
  touch(root_ / "out" / "matte" / "notes.txt");
  const fs::path notes = root_ / "out" / "matte" / "notes.txt";
  fs::last_write_time(
      notes, fs::last_write_time(root_ / "out" / "report.json") + std::chrono::milliseconds(20));
  const auto folder = make_partial_folder(root_ / "out", "report.json");
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().code, ErrorCode::kUsage);
  EXPECT_NE(folder.error().context.find("'matte/notes.txt'"), std::string::npos)
      << folder.error().context;
  EXPECT_TRUE(fs::exists(notes));
}

TEST_F(PartialPathTest, ARecordingIsReplacedByForceAlone) {
  fs::create_directory(root_ / "take");
  touch(root_ / "take" / "take.toml");
  touch(root_ / "take" / "notes.txt");
  const auto asked = check_output_folder(root_ / "take", "take.toml", Force::kNo);
  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().code, ErrorCode::kUsage);
  for (const char* word : {"a take", "files: 2", "--force"})
    EXPECT_NE(asked.error().context.find(word), std::string::npos) << asked.error().context;
  EXPECT_TRUE(check_output_folder(root_ / "take", "take.toml", Force::kYes));
  EXPECT_FALSE(check_output_folder(root_ / "take", "views.toml", Force::kYes)) << "no views";
  EXPECT_TRUE(check_output_folder(root_ / "new", "take.toml", Force::kNo));
}

TEST_F(PartialPathTest, AnOutputFileReplacesItsKindAlone) {
  for (const auto& [text, may] : {std::pair("# t x y z qx of a room\n", true), std::pair("", true),
                                  std::pair("[camera]\n", false), std::pair("# t", false)}) {
    std::ofstream(root_ / "poses.tum") << text;
    EXPECT_EQ(check_output_file(root_ / "poses.tum", kTrajectoryBegin, "OUT").has_value(), may)
        << text;
  }
  EXPECT_TRUE(check_output_file("/dev/null", kTrajectoryBegin, "OUT"));
  EXPECT_TRUE(check_output_file(root_ / "new.tum", kTrajectoryBegin, "OUT"));
  EXPECT_FALSE(check_output_file(root_, kTrajectoryBegin, "OUT"));
}

TEST_F(PartialPathTest, AFileKeepsItsRights) {
  const fs::path file = root_ / "scene.toml";
  touch(file);
  for (const unsigned mode : {0664U, 0600U}) {
    ASSERT_EQ(::chmod(file.c_str(), mode), 0);
    ASSERT_TRUE(write_file(file, "new"));
    struct stat now {};
    ASSERT_EQ(::stat(file.c_str(), &now), 0);
    EXPECT_EQ(now.st_mode & 07777U, mode);
  }
}

TEST_F(PartialPathTest, RefusesAFileAndAFolderOfOthers) {
  touch(root_ / "file");
  fs::create_directory(root_ / "theirs");
  touch(root_ / "theirs" / "thesis.tex");
  for (const char* name : {"file", "theirs"}) {
    const auto folder = make_partial_folder(root_ / name, "report.json");
    ASSERT_FALSE(folder);
    EXPECT_EQ(folder.error().code, ErrorCode::kUsage);
    EXPECT_FALSE(fs::exists(root_ / (std::string(name) + ".partial")));
  }
  EXPECT_TRUE(fs::exists(root_ / "theirs" / "thesis.tex"));
}

TEST_F(PartialPathTest, TextThatCannotBeWrittenLeavesNothing) {
  const auto result = write_file(root_ / "missing" / "report.json", "{}");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kIo);
  ASSERT_TRUE(write_file(root_ / "report.json", "{}"));
  EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);
}

TEST_F(PartialPathTest, AWriteProtectedFileStays) {
  const fs::path file = root_ / "scene.toml";
  ASSERT_TRUE(write_file(file, "mine"));
  fs::permissions(file, fs::perms::owner_read);
  const auto result = write_file(file, "{}");
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().context.find("is write-protected: permit"), std::string::npos);
  EXPECT_EQ(fs::file_size(file), 4u);
  EXPECT_FALSE(fs::exists(root_ / "scene.toml.partial"));
  fs::permissions(file, fs::perms::owner_all);
  EXPECT_TRUE(write_file(file, "{}"));
}

TEST_F(PartialPathTest, AFileNeverTakesThePlaceOfAFolder) {
  fs::create_directory(root_ / "theirs");
  touch(root_ / "theirs" / "thesis.tex");
  const auto result = write_file(root_ / "theirs", "{}");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kUsage);
  EXPECT_NE(result.error().context.find("folder"), std::string::npos) << result.error().context;
  EXPECT_TRUE(fs::exists(root_ / "theirs" / "thesis.tex"));
  EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);
}

TEST_F(PartialPathTest, APipeIsWrittenToAndStays) {
  const fs::path pipe = root_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const auto result = write_file(pipe, "{}");
  char text[8] = {};
  const ssize_t count = ::read(reader, text, sizeof text);
  ::close(reader);
  ASSERT_TRUE(result) << result.error().context;
  EXPECT_EQ(count, 2);
  EXPECT_STREQ(text, "{}");
  EXPECT_TRUE(fs::is_fifo(pipe));
  PartialPath partial(pipe);
  touch(partial.path());
  EXPECT_FALSE(partial.commit());
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(PartialPathTest, ALinkStaysAndItsTargetIsReplaced) {
  fs::create_directories(root_ / "disk");
  touch(root_ / "disk" / "report.json");
  fs::create_symlink(root_ / "disk" / "report.json", root_ / "link");
  ASSERT_TRUE(write_file(root_ / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(root_ / "link"));
  std::ifstream file(root_ / "disk" / "report.json");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(root_ / "disk"), {}), 1);
}

}  // namespace
}  // namespace mixrig
