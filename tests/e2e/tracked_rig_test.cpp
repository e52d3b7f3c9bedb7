// SPDX-License-Identifier: Apache-2.0
// A live rig whose fisheye has its own rate is tracked while it runs: a studio take is the rig, the
// time is injected.
#include <thread>

#include "host/capture/take/take.h"
#include "host/run/loop/run.h"
#include "host/run/session/session.h"
#include "tests/e2e/command.h"
#include "tests/e2e/composited.h"
#include "tests/e2e/tracked_scene.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"

namespace mixrig::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using capture::PoseLoss;

constexpr HostTime kBegin{500s};  ///< host time of the take's first frame

/// When the pictures of a take are due.
struct Due {
  std::vector<HostTime> plates, fisheye;
  static std::uint64_t until(const std::vector<HostTime>& all, HostTime now) {
    return static_cast<std::uint64_t>(std::upper_bound(all.begin(), all.end(), now) - all.begin());
  }
};

Due due_of(const fs::path& folder) {
  Due due;
  auto take = take::TakeReader::open(folder);
  EXPECT_TRUE(take);
  capture::Capture capture;
  std::optional<HostTime> first;
  for (int number = 1; take && number <= take->info().frames; ++number) {
    EXPECT_TRUE(take->read(number, capture));
    if (!first) first = capture.mid_exposure;
    due.plates.push_back(kBegin + (capture.mid_exposure - *first));
    if (capture.status_of(capture::Stream::kFisheye) == capture::StreamStatus::kFresh)
      due.fisheye.push_back(kBegin + (capture.fisheye_mid_exposure - *first));
  }
  return due;
}

class TrackedRig : public TrackedTake {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    ASSERT_NO_FATAL_FAILURE(make_room_and_take(40));
    std::string scene = tracker_scene(path("take"), path("room"), world_from_base(path("sweep")));
    scene.insert(scene.find("pose = \"tracker\""), "when_lost = \"hide\"\n");
    std::ofstream(path("take/scene_tracker.toml")) << scene;
    std::ofstream(path("rig.toml"))
        << "format = 1\nname = \"played\"\nplay_at_s = 500.0\n[[camera]]\nname = \"color\"\nuri = "
           "\"take:"
        << path("take") << "/color\"\n[[camera]]\nname = \"fisheye\"\nuri = \"take:" << path("take")
        << "/fisheye\"\n[depth]\nname = \"depth\"\nuri = \"take:" << path("take") << "/depth\"\n";
  }

  /// Advances the time while the session runs, only as fast as all due frames are composited.
  static void crank(SteppedClock& clock, session::Session& session, const Composited& composited,
                    const Due& due, const std::atomic<bool>& done) {
    const auto waits = [&](auto condition) {
      EXPECT_TRUE(comes_true([&] { return done || condition(); }));
    };
    const auto report = [&] { return *session.source->report(); };
    waits([&] { return report().streams[2].health.state == device::DeviceState::kStreaming; });
    while (!done && clock.now() < due.plates.back() + 1s) {
      clock.advance(5ms);
      waits([&] {
        const capture::SourceReport now = report();
        return now.streams[0].health.frames >= Due::until(due.plates, clock.now()) &&
               now.streams[1].health.frames >= Due::until(due.fisheye, clock.now()) &&
               now.waiting_events == 0 && composited.count() >= now.sets - now.left_out;
      });
    }
  }

  Result<session::RunReport> run_live() {
    SteppedClock clock;
    clock.advance(kBegin - 1s - clock.now());
    const std::atomic<bool> stop = false;
    session::SessionOptions options;
    options.scene = path("take/scene_tracker.toml");
    options.source = "rig:" + path("rig.toml");
    options.backend = {render::Backend::kCpu, 2};
    options.clock = &clock, options.stop = &stop;
    MIXRIG_ASSIGN(const auto session, session::open_session(options));
    session::RunParts parts;
    auto sink = std::make_unique<Composited>(poses_);
    const Composited& composited = *sink;
    parts.sinks.push_back(std::move(sink));
    std::atomic<bool> done = false;
    std::thread time([&] { crank(clock, *session, composited, due_of(path("take")), done); });
    auto report = session::run(*session, {}, clock, {}, std::move(parts));
    done = true;
    time.join();
    return report;
  }

  void is_followed();
  void is_lost_where_the_fisheye_is_unplugged();

  std::map<int, capture::CameraPose> poses_;
};

void TrackedRig::is_followed() {
  const auto report = run_live();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->pose.source, "tracker");
  EXPECT_EQ(report->live->streams[1].name, "fisheye");
  EXPECT_EQ(report->live->streams[1].health.frames, 16U) << "10 Hz of its own";
  EXPECT_GE(poses_.size(), 36U);
  // The fisheye's first two pictures are not paired yet; the third comes after 0.25 s.
  int lost_later = 0;
  for (const auto& [number, pose] : poses_) lost_later += number > 9 && !pose.ok() ? 1 : 0;
  EXPECT_EQ(lost_later, 0);
  const auto error = report->pose.error->to_json();
  EXPECT_LT(error.at("shift_mm").at("rms").get<double>(), 4);
  EXPECT_LT(error.at("turn_deg").at("rms").get<double>(), 0.08);
  std::printf("live: %s\n", report->pose.error->to_line().c_str());
}

void TrackedRig::is_lost_where_the_fisheye_is_unplugged() {
  std::ifstream in(path("take/fisheye.csv"));
  std::string head, line;
  for (int row = 0; row <= 8 && std::getline(in, line); ++row) head += line + "\n";
  in.close();
  std::ofstream(path("take/fisheye.csv")) << head;  // the cable is pulled after picture 8, 0.71 s
  const auto report = run_live();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->live->streams[1].name, "fisheye");
  EXPECT_EQ(report->live->streams[1].health.frames, 8U);
  int lost_later = 0, frozen = 0;
  for (const auto& [number, pose] : poses_) {
    if ((number - 1) / 25.0 < 0.73 + 0.1) continue;
    ++lost_later;
    EXPECT_TRUE(pose.loss == PoseLoss::kTooOld || pose.loss == PoseLoss::kNoPicture) << number;
    frozen += pose.ok() ? 1 : 0;
  }
  EXPECT_EQ(frozen, 0);
  EXPECT_GE(lost_later, 15);
  EXPECT_GE(report->pose.frames.frames[static_cast<std::size_t>(PoseLoss::kNoPicture)], 14U);
}

// Both cases share one take and one room.
TEST_F(TrackedRig, IsFollowedUntilItsFisheyeIsUnplugged) {
  is_followed();
  poses_.clear();
  is_lost_where_the_fisheye_is_unplugged();
}

}  // namespace
}  // namespace mixrig::test
