// SPDX-License-Identifier: Apache-2.0
// A chair that stands elsewhere than in the background of a live run is accepted by an order.
#include <csignal>

#include "tests/e2e/command.h"
#include "tests/e2e/slow_take.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"

namespace mixrig::test {
namespace {
namespace fs = std::filesystem;

class LiveChange : public CommandTest {
 protected:
  static constexpr const char* kTake =
      " --scenario walk --rig kinect2 --seed 5 --size 160x128 --plain"
      " --eye 0.9,2.1,1.5 --look-at 3.9,3.2,0.7 ";

  /// Makes a take of an empty room, and one in which the chair was moved before it began.
  void make_takes() const {
    ASSERT_EQ(studio("was", std::string(kTake) + "--frames 3"), 0);
    ASSERT_EQ(mixrig("scan --take " + path("was") + " --frames 1-3 " + path("room")), 0);
    ASSERT_EQ(studio("take", std::string(kTake) + "--moved-chair --frames 120"), 0);
    // At 6 frames a second, one of five is examined: the change is reported after 4 s and learned
    // from the nine examinations after the order by second 15. The exchange then has 9 s left on a
    // loaded machine.
    slow_down(path("take"), 5);
    std::ofstream(path("rig.toml"))
        << "format = 1\nname = \"played\"\n[[camera]]\nname = \"color\"\nuri = \"take:"
        << path("take/color") << "\"\n[depth]\nuri = \"take:" << path("take/depth") << "\"\n";
    write_scene("before.toml", "room");
    write_scene("after.toml", "accepted");
  }
  void write_scene(const std::string& name, const std::string& room) const {
    std::ifstream in(path("take/scene.toml"));
    std::ofstream out(path("take/" + name));
    for (std::string text; std::getline(in, text);)
      out << (text.starts_with("learn = ") ? "model = \"../" + room + "\"" : text) << '\n';
  }
  std::string text_of(const std::string& name) const {
    std::ifstream file(path(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(LiveChange, AnOrderWhileDevicesPlayIsFollowed) {
  make_takes();
  // The process id of the shell becomes that of the command.
  const std::string command = "echo $$ > " + path("pid") + "; exec " MIXRIG_COMMAND " run " +
                              path("take/before.toml") + " --source rig:" + path("rig.toml") +
                              " --change-after 1 --backend cpu --save-room " + path("accepted") +
                              " --json " + path("run.json");
  ChildProcess child({"sh", "-c", command}, 240, path("log"));
  ASSERT_TRUE(comes_true([&] { return text_of("log").find("has changed") != std::string::npos; }))
      << text_of("log");
  kill(static_cast<pid_t>(std::stol(text_of("pid"))), SIGUSR1);
  ASSERT_EQ(child.wait(), 0) << text_of("log");
  const auto live = report("run.json");
  const auto& changes = live.at("room_changes");
  EXPECT_EQ(changes.at("accepted"), 1) << text_of("log");
  EXPECT_EQ(changes.at("swap_ms").size(), 3U) << "the compositor was exchanged";
  ASSERT_EQ(mixrig("run " + path("take/after.toml") + " --source take:" + path("take") +
                   " --watch --change-after 1 --frames 50-90 --json " + path("after.json")),
            0);
  const auto after = report("after.json").at("room_changes").at("found");
  EXPECT_TRUE(after.empty()) << after.dump();
}

}  // namespace
}  // namespace mixrig::test
