// SPDX-License-Identifier: Apache-2.0
// Compiled programs that are stored between runs.
#include "host/render/gles/gl/program_file.h"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <vector>

#include "host/render/gles/gl/gl_program.h"
#include "tests/gl/gl_fixture.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::test {
namespace {

using namespace render::gles;
namespace fs = std::filesystem;

TEST(ProgramFile, gives_back_what_was_kept) {
  const std::string file = to_program_file(7, {0x8740, "some bytes"});
  const auto binary = from_program_file(7, file);
  ASSERT_TRUE(binary);
  EXPECT_EQ(binary->format, 0x8740U);
  EXPECT_EQ(binary->bytes, "some bytes");
}

TEST(ProgramFile, refuses_another_key_and_every_damage) {
  const std::string file = to_program_file(7, {1, "some bytes"});
  EXPECT_FALSE(from_program_file(8, file));
  EXPECT_FALSE(from_program_file(7, file + "x"));
  for (std::size_t i = 0; i < file.size(); ++i) {
    EXPECT_FALSE(from_program_file(7, file.substr(0, i))) << i;
    std::string damaged = file;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_FALSE(from_program_file(7, damaged)) << i;
  }
}

TEST(ProgramFile, key_tells_texts_apart) {
  EXPECT_NE(program_key({"ab", "c"}), program_key({"a", "bc"}));
  EXPECT_NE(program_key({"a"}), program_key({"b"}));
  EXPECT_EQ(program_key({"a", "b"}), program_key({"a", "b"}));
}

/// Uses its own cache folder.
class KeptProgram : public GlTest {
 protected:
  KeptProgram() {
    const char* before = std::getenv("XDG_CACHE_HOME");
    if (before != nullptr) before_ = before;
    setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);
  }
  ~KeptProgram() override {
    if (before_)
      setenv("XDG_CACHE_HOME", before_->c_str(), 1);
    else
      unsetenv("XDG_CACHE_HOME");
  }
  static bool make() {
    const auto program = make_program("fullscreen.vert", "plate.frag");
    EXPECT_TRUE(program) << program.error().context;
    return program && program->location("plate") >= 0;
  }
  std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    if (!fs::exists(folder_.path() / "mixrig" / "programs")) return found;
    for (const auto& entry : fs::directory_iterator(folder_.path() / "mixrig" / "programs"))
      found.push_back(entry.path());
    return found;
  }
  TemporaryFolder folder_;
  std::optional<std::string> before_;
};

TEST_F(KeptProgram, is_one_file_that_the_next_run_loads) {
  GLint formats = 0;
  glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
  if (formats == 0) GTEST_SKIP() << "this driver gives no program binaries";
  ASSERT_TRUE(make());
  ASSERT_EQ(files().size(), 1U);
  const auto written = fs::last_write_time(files()[0]);
  fs::last_write_time(files()[0], written - std::chrono::hours(1));
  ASSERT_TRUE(make());
  EXPECT_EQ(fs::last_write_time(files()[0]), written - std::chrono::hours(1)) << "not built again";
}

TEST_F(KeptProgram, is_built_again_where_the_file_is_damaged) {
  GLint formats = 0;
  glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
  if (formats == 0) GTEST_SKIP() << "this driver gives no program binaries";
  ASSERT_TRUE(make());
  const fs::path path = files().at(0);
  const auto size = fs::file_size(path);
  for (const std::uintmax_t cut : {std::uintmax_t{0}, std::uintmax_t{17}, size - 1}) {
    fs::resize_file(path, cut);
    ASSERT_TRUE(make()) << cut;
    EXPECT_EQ(fs::file_size(path), size) << "written again";
  }
  // A valid file, but not of this driver.
  std::string file = read_program_file(path);
  const std::uint64_t key = std::stoull(path.stem().string(), nullptr, 16);
  std::ofstream(path, std::ios::binary) << to_program_file(key, {0x1234, "no program at all"});
  ASSERT_TRUE(make());
  EXPECT_EQ(read_program_file(path).size(), file.size());
}

TEST_F(KeptProgram, without_a_folder_to_write_it_is_built) {
  setenv("XDG_CACHE_HOME", "/proc/none", 1);
  EXPECT_TRUE(make());
}

}  // namespace
}  // namespace mixrig::test
