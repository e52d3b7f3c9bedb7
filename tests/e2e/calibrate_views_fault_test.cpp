// SPDX-License-Identifier: Apache-2.0
// `mixrig calibrate views` with played cameras: Ctrl-C and a camera that fails during the job.
#include <csignal>

#include "tests/e2e/rig_error.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"

namespace mixrig::test {
namespace {

class CalibrateViewsFault : public RefusingCommandTest {
 protected:
  /// Makes a take of a board that a person holds, and a rig.toml that plays it.
  void make_played_board() {
    ASSERT_EQ(
        studio("take",
               "--plain --scenario board --hand --rig sr3000 --seed 7 --views 2 --size 320x256"
               " --fisheye-size 64x64 --rest 1.5 --move 0.2"),
        0);
    std::ofstream rig(path("rig.toml"));
    rig << "format = 1\n";
    for (const auto& [table, name] : {std::pair("[[camera]]", "color"), {"[depth]", "depth"}})
      rig << table << "\nname = \"" << name << "\"\nuri = \"take:" << path("take") << "/" << name
          << "\"\n";
  }
  std::string words() const {
    return "calibrate views " + path("views") + " --rig " + path("rig.toml") +
           " --board checkerboard:9x6:70mm --frames 3 --json " + path("v.json");
  }
  /// Number of views whose pictures are all there.
  int whole_views() const {
    int views = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path("views"))) {
      EXPECT_TRUE(!entry.is_regular_file() || entry.file_size() > 0) << entry.path();
      views += entry.path().parent_path().filename() == "target" ? 1 : 0;
    }
    return views;
  }
};

TEST_F(CalibrateViewsFault, CtrlCAndACameraThatFailsKeepWhatThereIs) {
  ASSERT_NO_FATAL_FAILURE(make_played_board());
  std::vector<std::string> all{MIXRIG_COMMAND};
  std::istringstream split(words());
  for (std::string word; split >> word;) all.push_back(word);
  ChildProcess child(std::move(all), 120, path("said"), path("errors"));
  const auto kept = [&] {
    return text_of_file(path("errors")).find("view 1 kept") != std::string::npos;
  };
  ASSERT_TRUE(comes_true(kept)) << text_of_file(path("errors"));
  child.signal(SIGINT);
  EXPECT_EQ(child.wait(), 0) << text_of_file(path("errors"));
  EXPECT_NE(text_of_file(path("said")).find("views, "), std::string::npos);
  EXPECT_EQ(report("v.json").at("ended"), "stopped");
  EXPECT_GE(whole_views(), 1);
  std::filesystem::remove_all(path("views"));
  std::filesystem::resize_file(path("take/color/000045.png"), 1000);
  std::string said;
  EXPECT_EQ(refused(words(), said), 1);
  EXPECT_NE(said.find("camera 'color' (take:"), std::string::npos) << said;
  EXPECT_NE(said.find("has failed"), std::string::npos) << said;
  EXPECT_NE(said.find("the " + std::to_string(whole_views()) + " views so far are in"),
            std::string::npos)
      << said;
}

}  // namespace
}  // namespace mixrig::test
