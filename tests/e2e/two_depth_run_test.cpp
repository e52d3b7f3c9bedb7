// SPDX-License-Identifier: Apache-2.0
// A rig of two depth cameras runs live: a take of the studio serves as its three cameras.
#include <algorithm>
#include <regex>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

bool same_depth(const Image<std::uint16_t>& a, const Image<std::uint16_t>& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

class TwoDepthRun : public CommandTest {
 protected:
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(path(file)) << text;
  }
  void learn_five() const {
    std::ifstream in(path("take/scene.toml"));
    const std::string text(std::istreambuf_iterator<char>(in), {});
    in.close();
    write("take/scene.toml", std::regex_replace(text, std::regex("learn = .*"), "learn = [1, 5]"));
  }
  std::string table(const char* head, const std::string& name, const char* stream) const {
    return std::string(head) + "\nname = \"" + name + "\"\nuri = \"take:" + path("take") + stream +
           "\"\n";
  }
};

/// Each depth picture of the live run equals one of the run of the take bit by bit, and none equals
/// one of a run with the first camera alone.
TEST_F(TwoDepthRun, IsCompositedLiveAsFromTheTake) {
  // The frames after the five learned ones pass while the compositor opens, which takes two to four
  // seconds at a load of 6. There are many frames, a second apart, so that two are left.
  constexpr double kFrame_s = 1;
  constexpr int kFrames = 18;
  ASSERT_EQ(
      studio("take",
             "--plain --scenario walk --rig kinect2+kinect2 --seed 7 --size 160x120 --frames " +
                 std::to_string(kFrames)),
      0);
  learn_five();
  std::ifstream in(path("take/poses.txt"));
  std::string line, slow;
  for (int frame = 0; std::getline(in, line);)
    if (!line.starts_with('#'))
      slow += std::to_string(kFrame_s * frame++) + line.substr(line.find(' ')) + "\n";
  in.close();
  std::ofstream(path("take/poses.txt")) << slow;
  const std::string take = "take:" + path("take");
  const std::string color = "format = 1\n" + table("[[camera]]", "color", "/color");
  write("two.toml",
        color + table("[[depth]]", "left", "/depth") + table("[[depth]]", "right", "/depth2"));
  write("one.toml", color + table("[depth]", "left", "/depth"));
  const auto run = [&](const std::string& source, const std::string& out) {
    EXPECT_EQ(mixrig("run " + path("take/scene.toml") + " --source " + source +
                     " --backend cpu --format png --out " + path(out)),
              0);
    std::vector<Image<std::uint16_t>> pictures;
    for (int n = 1; n <= report(out + "/report.json").at("frames").get<int>(); ++n) {
      Image<std::uint16_t> picture;
      const std::string number = std::to_string(n);
      const std::string name =
          out + "/composite/depth/" + std::string(6 - number.size(), '0') + number + ".png";
      EXPECT_TRUE(image_io::read_gray16(path(name), picture)) << name;
      pictures.push_back(std::move(picture));
    }
    return pictures;
  };
  const auto live = run("rig:" + path("two.toml"), "live"), played = run(take, "played"),
             alone = run("rig:" + path("one.toml"), "alone");
  const auto holds = [](const auto& pictures, const Image<std::uint16_t>& one) {
    return std::any_of(pictures.begin(), pictures.end(),
                       [&](const auto& other) { return same_depth(one, other); });
  };
  ASSERT_GE(live.size(), 2U);
  for (const auto& picture : live) {
    EXPECT_TRUE(holds(played, picture));
    EXPECT_FALSE(holds(alone, picture));
  }
  const auto streams = report("live/report.json").at("live").at("streams");
  ASSERT_EQ(streams.size(), 3U);
  EXPECT_EQ(streams[2].at("pairing").at("paired"), kFrames);
}

}  // namespace
}  // namespace mixrig::test
