// SPDX-License-Identifier: Apache-2.0
// `mixrig scan --rig` in a temporary folder, with the studio as the rig.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/e2e/command.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"

namespace mixrig::test {

namespace fs = std::filesystem;

class LiveScan : public CommandTest {
 protected:
  void write_rig(const std::string& name, const std::string& extra) const {
    std::ofstream(path(name)) << "format = 1\nname = \"studio\"\n" << extra;
  }
  std::string live_rig() const {
    const std::string studio = "uri = \"studio:sweep,31,sr3000,,64x48/";
    return "calibration = \"take/truth/calibration.toml\"\n[[camera]]\nname = \"color\"\n" +
           studio + "target\"\n[depth]\n" + studio + "tof\"\n[pan_tilt]\n" + studio + "head\"\n";
  }
  /// Exit status and output of a command that may fail.
  std::pair<int, std::string> tried(std::vector<std::string> words) const {
    words.insert(words.begin(), MIXRIG_COMMAND);
    const int status = ChildProcess(std::move(words), 120, path("tried")).wait();
    return {status, text_of("tried")};
  }
  void make_take() const {
    ASSERT_EQ(studio("take",
                     "--scenario sweep --plain --size 64x48 --rig sr3000 --seed 31 --field 80x60 "
                     "--view-frames 2"),
              0);
  }
  std::string text_of(const std::string& name) const {
    std::ifstream file(path(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::vector<std::string> scan(const std::string& overlap,
                                const std::string& field = "80x60") const {
    return {"scan",         "--rig",     path("rig.toml"), path("room"),    "--field",
            field,          "--overlap", overlap,          "--view-frames", "2",
            "--keep-sweep", "--json",    path("room.json")};
  }
  nlohmann::json judged(const std::string& sweep) const {
    EXPECT_EQ(mixrig("scan --take " + path(sweep) + " --calibration " +
                     path("take/truth/calibration.toml") + " " + path("judged") +
                     " --evaluate --json " + path("judged.json")),
              0);
    return report("judged.json").at("evaluate");
  }
};

}  // namespace mixrig::test
