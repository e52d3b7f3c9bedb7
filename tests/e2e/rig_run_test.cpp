// SPDX-License-Identifier: Apache-2.0
// The command with live devices: recordings and the studio are the cameras.
#include <algorithm>
#include <regex>

#include <gtest/gtest.h>
#include <signal.h>

#include "hal/base/image.h"
#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"
#include "tests/e2e/slow_take.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"
#include "tests/support/udp_listener.h"

namespace mixrig::test {
namespace {
namespace fs = std::filesystem;

template <typename T>
bool same(const Image<T>& a, const Image<T>& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

class RigRun : public CommandTest {
 protected:
  void write_rig(const std::string& color, const std::string& depth) const {
    std::ofstream(folder_ / "rig.toml") << "format = 1\nname = \"played\"\n"
                                        << "[[camera]]\nname = \"color\"\nuri = \"" << color
                                        << "\"\n[depth]\nuri = \"" << depth << "\"\n";
  }
  /// The rate is one that a loaded machine can follow; the first three frames give the background.
  void make_take(int frames) const {
    ASSERT_EQ(
        studio("take", "--plain --scenario walk --rig sr3000 --seed 31 --size 160x120 --frames " +
                           std::to_string(frames)),
        0);
    replace("take/take.toml", "rate_hz = [0-9.]+", "rate_hz = 8.0");
    replace("take/scene.toml", "learn = .*", "learn = [1, 3]");
    write_rig("take:" + path("take") + "/color", "take:" + path("take") + "/depth");
  }
  void replace(const std::string& file, const char* pattern, const char* by) const {
    std::ifstream in(path(file));
    const std::string text(std::istreambuf_iterator<char>(in), {});
    std::ofstream(path(file)) << std::regex_replace(text, std::regex(pattern), by);
  }
  /// Runs until `file` exists, then sends SIGINT; returns the exit status.
  int interrupted(std::vector<std::string> words, const std::string& file) const {
    words.insert(words.begin(), MIXRIG_COMMAND);
    ChildProcess child(std::move(words), 240, path("log"));
    EXPECT_TRUE(comes_true([&] { return fs::exists(path(file)); })) << file;
    child.signal(SIGINT);
    const int status = child.wait();
    if (status != 0) {
      std::ifstream log(path("log"));
      ADD_FAILURE() << std::string(std::istreambuf_iterator<char>(log), {});
    }
    return status;
  }
};

TEST_F(RigRun, ATakePlayedAsDevicesIsCompositedAndEveryMomentIsAccountedFor) {
  make_take(24);
  ASSERT_EQ(mixrig("run " + path("take/scene.toml") + " --source rig:" + path("rig.toml") +
                   " --backend cpu --format none --out " + path("out")),
            0);
  const auto report = this->report("out/report.json");
  EXPECT_EQ(report.at("ended"), "end of the source");
  const auto& live = report.at("live");
  EXPECT_EQ(live.at("streams").size(), 2U);
  EXPECT_EQ(live.at("streams")[0].at("frames"), 24);
  EXPECT_GT(report.at("frames").get<int>(), 0);
  // Every set is used for learning, composited or dropped.
  if (live.at("dropped_events") == 0) {
    EXPECT_EQ(live.at("sets"), 24);
    EXPECT_EQ(live.at("left_out"), 0);
  }
}

TEST_F(RigRun, CtrlCEndsALiveRunWithAWholeOutput) {
  make_take(4);
  write_rig("studio:walk,31,sr3000,100000,160x120/target",
            "studio:walk,31,sr3000,100000,160x120/tof");
  ASSERT_EQ(interrupted({"run", path("take/scene.toml"), "--source", "rig:" + path("rig.toml"),
                         "--backend", "cpu", "--out", path("out")},
                        "out.partial/composite.partial/color/000005.png"),
            0);
  const auto report = this->report("out/report.json");
  EXPECT_EQ(report.at("ended"), "stopped");
  EXPECT_GE(report.at("frames").get<int>(), 5);
  EXPECT_FALSE(fs::exists(path("out.partial")));
  EXPECT_EQ(mixrig("info " + path("out/composite")), 0);
}

/// A ball falls while somebody walks through the room.
TEST_F(RigRun, EventsAndPlacesArriveWhileALiveRunGoesOn) {
  make_take(4);
  write_rig("studio:walk,31,sr3000,100000,160x120/target",
            "studio:walk,31,sr3000,100000,160x120/tof");
  UdpListener json, osc;
  std::ofstream(path("take/scene.toml"), std::ios::app)
      << "\n[[object]]\nname = \"a ball\"\nmodel = \"models/statue.glb\"\nscale = 0.1\n"
      << "position_m = [2.6, 2.15, 1.0]\nphysics = { mass_kg = 0.4, shape = \"ball\" }\n"
      << "[events]\npeople = true\nudp = \"" << json.address() << "\"\nosc = \"" << osc.address()
      << "\"\n";
  ChildProcess child(
      {MIXRIG_COMMAND, "run", path("take/scene.toml"), "--source", "rig:" + path("rig.toml"),
       "--backend", "cpu", "--format", "none", "--out", path("out")},
      240, path("log"));
  bool hit = false, person = false, osc_hit = false, osc_person = false, osc_people = false;
  EXPECT_TRUE(comes_true([&] {
    for (std::string text = json.next(); !text.empty(); text = json.next()) {
      const auto told = nlohmann::json::parse(text);
      person |= told.contains("people") && !told["people"].empty();
      hit |= told.value("event", "") == "hit" && told["object"] == "a ball" &&
             told.value("part", "") == "floor";
    }
    using std::string_literals::operator""s;
    for (std::string text = osc.next(); !text.empty(); text = osc.next()) {
      osc_hit |= text.starts_with("/mixrig/touch/a_ball/hit\0"s);
      osc_person |= text.starts_with("/mixrig/person\0\0,ifff\0"s);
      osc_people |= text.starts_with("/mixrig/people\0\0,"s);
    }
    return hit && person && osc_hit && osc_person && osc_people;
  })) << hit
      << person << osc_hit << osc_person << osc_people;
  child.signal(SIGINT);
  EXPECT_EQ(child.wait(), 0);
  const auto events = report("out/report.json").at("events");
  EXPECT_GE(events["hit"], 1);
  EXPECT_GT(events["osc"]["sent"], events["datagrams"]["sent"]);
}

TEST_F(RigRun, CtrlCEndsARunOfATakeWithAWholeOutput) {
  make_take(4);
  ASSERT_EQ(interrupted(
                {"run", path("take/scene.toml"), "--source", "studio:walk,31,sr3000,100000,160x120",
                 "--backend", "cpu", "--out", path("out")},
                "out.partial/composite.partial/color/000005.png"),
            0);
  EXPECT_EQ(report("out/report.json").at("ended"), "stopped");
  EXPECT_FALSE(fs::exists(path("out.partial")));
  EXPECT_EQ(mixrig("info " + path("out/composite")), 0);
}

TEST_F(RigRun, ARecordingOfAPlayedTakeHoldsItsPixels) {
  make_take(30);
  ASSERT_EQ(mixrig("record --rig " + path("rig.toml") + " " + path("again") +
                   " --duration 60 --format png --json " + path("record.json")),
            0);
  EXPECT_EQ(report("record.json").at("ended"), "end of the cameras");
  std::ifstream ticks(path("again/ticks.csv"));
  std::string line;
  std::getline(ticks, line);
  int compared = 0;
  while (std::getline(ticks, line)) {
    int frame = 0, counter = 0;
    long tick = 0;
    char stream[16];
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%15[^,],%ld,%d", &frame, stream, &tick, &counter), 4);
    const std::string kind = stream;
    char was[64], is[64];
    std::snprintf(was, sizeof was, "take/%s/%06d.png", kind.c_str(), counter);
    std::snprintf(is, sizeof is, "again/%s/%06d.png", kind.c_str(), frame);
    if (kind == "color") {
      Image<Rgb8> a, b;
      ASSERT_TRUE(image_io::read_rgb8(path(was), a));
      ASSERT_TRUE(image_io::read_rgb8(path(is), b));
      ASSERT_TRUE(same(a, b)) << line;
    } else {
      Image<std::uint16_t> a, b;
      ASSERT_TRUE(image_io::read_gray16(path(was), a));
      ASSERT_TRUE(image_io::read_gray16(path(is), b));
      ASSERT_TRUE(same(a, b)) << line;
    }
    ++compared;
  }
  EXPECT_GE(compared, 2);
}

TEST_F(RigRun, AHeadThatTurnsIsFollowedFromDevicesAsFromTheTake) {
  ASSERT_EQ(
      studio("take", "--plain --scenario pan --rig sr3000 --seed 31 --size 64x48 --frames 40"), 0);
  // 3 frames a second: a loaded machine can follow, and the head turns little between two answers.
  slow_down(path("take"), 8);
  ASSERT_EQ(mixrig("scan --take " + path("take") + " --frames 1-6 " + path("take/room")), 0);
  replace("take/scene_pan_tilt.toml", "learn = .*", "model = \"room\"");
  write_rig("take:" + path("take") + "/color", "take:" + path("take") + "/depth");
  std::ofstream(folder_ / "rig.toml", std::ios::app)
      << "[pan_tilt]\nuri = \"take:" << path("take") << "/head\"\n";
  const std::string run = "run " + path("take/scene_pan_tilt.toml") + " --backend cpu --source ";
  ASSERT_EQ(mixrig(run + "take:" + path("take") + " --json " + path("take.json")), 0);
  ASSERT_EQ(mixrig(run + "rig:" + path("rig.toml") + " --json " + path("live.json")), 0);
  const auto take = report("take.json").at("pose"), live = report("live.json").at("pose");
  ASSERT_EQ(live.at("source"), "pan_tilt");
  // A loaded machine may drop sets and begin before the head answers; the sets that it composites
  // must be right.
  EXPECT_GE(live.at("frames").get<int>(), 10);
  EXPECT_LE(live.at("lost").get<int>(), 5);
  const auto rms = [](const auto& pose, const char* what) {
    return pose.at("error").at(what).at("rms").template get<double>();
  };
  // The encoder's step of 0.0514 deg, uniformly distributed: sigma 0.0148 deg, below 1 mm at arm's
  // length.
  EXPECT_LE(rms(take, "turn_deg"), 0.03);
  EXPECT_LE(rms(live, "turn_deg"), 0.03);
  EXPECT_LE(rms(live, "shift_mm"), 3.0);
}

TEST_F(RigRun, ADiskThatFillsUpLeavesAReadableTake) {
  if (std::system("unshare --mount --map-root-user true 2>/dev/null") != 0)
    GTEST_SKIP() << "no small disk can be mounted here (unshare --mount)";
  make_take(40);
  fs::create_directory(path("disk"));
  std::ofstream(folder_ / "fill.sh")
      << "mount -t tmpfs -o size=5m none " << path("disk") << " || exit 99\n"
      << MIXRIG_COMMAND << " record --rig " << path("rig.toml") << " " << path("disk/take")
      << " --duration 60 --format png --keep-free 0 2>" << path("words") << "\necho $? >"
      << path("status") << "\n"
      << MIXRIG_COMMAND << " info " << path("disk/take") << " --json " << path("info.json") << "\n";
  ASSERT_EQ(std::system(("unshare --mount --map-root-user sh " + path("fill.sh") + " >" +
                         path("log") + " 2>&1")
                            .c_str()),
            0);
  int status = -1;
  std::ifstream(path("status")) >> status;
  EXPECT_EQ(status, 1);
  std::ifstream words(path("words"));
  const std::string line(std::istreambuf_iterator<char>(words), {});
  EXPECT_NE(line.find("No space left on device"), std::string::npos) << line;
  EXPECT_NE(line.find("the take ends after"), std::string::npos) << line;
  EXPECT_GE(report("info.json").at("frames").get<int>(), 1);
}

TEST_F(RigRun, AMissingRigAndAMissingTakeAreNamed) {
  make_take(4);
  const auto status = [&](const std::string& source) {
    return WEXITSTATUS(
        std::system((std::string(MIXRIG_COMMAND) + " run " + path("take/scene.toml") +
                     " --source " + source + " --out " + path("out") + " 2>" + path("log"))
                        .c_str()));
  };
  EXPECT_EQ(status("rig:" + path("none.toml")), 2);
  write_rig("take:" + path("none") + "/color", "take:" + path("none") + "/depth");
  EXPECT_EQ(status("rig:" + path("rig.toml")), 2);
  write_rig("v4l2:/dev/none", "usb:1209:0001");
  EXPECT_EQ(status("rig:" + path("rig.toml")), 1) << "it may be plugged in: a service tries again";
  EXPECT_FALSE(fs::exists(path("out")));
}

}  // namespace
}  // namespace mixrig::test
