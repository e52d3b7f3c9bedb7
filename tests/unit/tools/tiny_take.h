// SPDX-License-Identifier: Apache-2.0
// A folder with a tiny take and scene, and the real command run in it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/without_progress.h"

namespace mixrig::test {
namespace fs = std::filesystem;

struct Outcome {
  int status = -1;  ///< exit status; -1 where a signal ended it
  std::string out, err;
  int error_lines() const { return static_cast<int>(std::count(err.begin(), err.end(), '\n')); }
};

/// A folder with take/, four frames of 32x24 px of a wall at 2 m, and scene.toml, which learns from
/// the first three.
class TinyTake {
 public:
  TinyTake() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-cli-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
    fs::create_directories(root_ / "take" / "color");
    fs::create_directories(root_ / "take" / "depth");
    for (int i = 1; i <= 4; ++i) write_frame(i);
    text("take/take.toml", kTake);
    text("scene.toml", kScene);
  }
  TinyTake(const TinyTake&) = delete;
  TinyTake& operator=(const TinyTake&) = delete;
  ~TinyTake() { fs::remove_all(root_); }

  void write_frame(int number) const {
    char name[16];
    std::snprintf(name, sizeof name, "%06d.png", number);
    const Image<Rgb8> color({32, 24}, {100, 110, 120});
    const Image<std::uint16_t> depth({32, 24}, 2000);
    EXPECT_TRUE(image_io::write_png(root_ / "take" / "color" / name, color.view()));
    EXPECT_TRUE(image_io::write_png(root_ / "take" / "depth" / name, depth.view()));
  }
  void text(const std::string& name, const std::string& words) const {
    std::ofstream(root_ / name) << words;
  }
  std::string text_of(const std::string& name) const {
    std::ifstream file(root_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Replaces the first `from` in a file; fails the test where it does not occur.
  void edit(const std::string& name, const std::string& from, const std::string& to) const {
    std::string words = text_of(name);
    const std::size_t at = words.find(from);
    ASSERT_NE(at, std::string::npos) << name << " has no " << from;
    text(name, words.replace(at, from.size(), to));
  }
  /// Truncates a file to its first `bytes`.
  void cut(const std::string& name, std::size_t bytes) const {
    fs::resize_file(root_ / name, bytes);
  }
  fs::path path(const std::string& name) const { return root_ / name; }

  /// All files and folders in it.
  std::set<std::string> contents() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(root_))
      names.insert(fs::relative(entry.path(), root_).string());
    return names;
  }

  /// Runs `mixrig WORDS` in the folder, with `environment` (NAME=VALUE ...) before it.
  Outcome mixrig(const std::string& words, const std::string& environment = "") const {
    const fs::path out = root_.string() + ".out", err = root_.string() + ".err";
    const std::string line = "cd " + root_.string() + " && env " + environment + " " +
                             MIXRIG_COMMAND + " " + words + " >" + out.string() + " 2>" +
                             err.string() + " </dev/null";
    const int raw = std::system(line.c_str());
    Outcome outcome{WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, slurp(out),
                    without_progress(slurp(err))};
    fs::remove(out);
    fs::remove(err);
    return outcome;
  }

 private:
  static std::string slurp(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static constexpr const char* kTake = R"(format = 1
name = "tiny"
[color]
path = "color/%06d.png"
count = 4
rate_hz = 25.0
[depth]
path = "depth/%06d.png"
count = 4
rate_hz = 25.0
[target]
size_px = [32, 24]
fx = 30.0
fy = 30.0
cx = 15.5
cy = 11.5
[tof]
size_px = [32, 24]
fx = 30.0
fy = 30.0
cx = 15.5
cy = 11.5
[target_from_tof]
rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
translation_m = [0.0, 0.0, 0.0]
)";
  static constexpr const char* kScene = R"([camera]
pose = "identity"
[background]
learn = [1, 3]
[light]
ambient = 0.5
[key]
threshold_m = 0.05
)";
  fs::path root_;
};

}  // namespace mixrig::test
