// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/room_sweep.h"

#include <utility>

#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "hal/base/thread_priority.h"
#include "host/room/sweep/live_scan.h"
#include "host/room/sweep/room_scan.h"
#include "host/scene/pose_kind.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;
using Phase = page::SweepState::Phase;

constexpr const char* kRooms = "rooms";

/// "room 1" that is free, as room and as sweep.
std::string free_room_name(const fs::path& rooms) {
  for (int i = 1;; ++i) {
    const fs::path folder = rooms / fmt::format("room {}", i);
    if (!fs::exists(folder) && !fs::exists(sweep_folder(folder))) return folder.filename().string();
  }
}

/// Remembers the head's angles, and returns the head to them.
class HeadPlace {
 public:
  explicit HeadPlace(live::RunningRig& rig) : rig_(rig) { rig_.listen(true); }
  ~HeadPlace() {
    if (at_) (void)rig_.move_to(*at_);
    rig_.listen(false);
  }
  HeadPlace(const HeadPlace&) = delete;
  HeadPlace& operator=(const HeadPlace&) = delete;

  /// Errors: kTimeout where no frame has its angles.
  Result<void> find(const std::atomic<bool>& stop, const Clock& clock) {
    constexpr Duration kPatience = std::chrono::seconds(10), kWait = std::chrono::milliseconds(100);
    const HostTime give_up = clock.now() + kPatience;
    while (!at_ && !stop) {
      capture::Capture frame;
      HostTime exposed_from{};
      MIXRIG_ASSIGN(const bool there, rig_.next(kWait, frame, exposed_from));
      if (there) at_ = frame.pan_tilt;
      if (!at_ && clock.now() > give_up)
        return Error{ErrorCode::kTimeout,
                     "no frame has the angles of the pan-tilt unit: check its "
                     "cable; mixrig diag says more"};
    }
    return {};
  }

 private:
  live::RunningRig& rig_;
  std::optional<device::PanTiltAngles> at_;
};

}  // namespace

RoomSweep::~RoomSweep() {
  stop_ = true;
  const std::lock_guard lock(thread_mutex_);
  if (thread_.joinable()) thread_.join();
}

std::string RoomSweep::why_not() const {
  if (!session_.rig) return "a recording is played: a scan turns the head of a live rig";
  if (!session_.rig->runs())
    return "this run has no pan-tilt head: it needs [pan_tilt] in rig.toml and a camera.pose that "
           "follows it, such as \"pan_tilt\"";
  if (scene::kind_of(session_.scene.pose_source).head != scene::HeadUse::kFollowed)
    return "camera.pose of the scene does not follow the head: use \"pan_tilt\", or end the run "
           "and use mixrig scan --rig";
  if (session_.calibration.file.empty())
    return "the rig has no calibration, which says where the head turns: mixrig calibrate ptu";
  return {};
}

page::SweepState RoomSweep::state() const {
  page::SweepState state;
  {
    const std::lock_guard lock(mutex_);
    state = state_;
  }
  state.why_not = why_not();
  state.possible = state.why_not.empty();
  return state;
}

Result<void> RoomSweep::start(const page::StartSweep& wanted) {
  if (std::string why = why_not(); !why.empty()) return Error{ErrorCode::kUnsupported, why};
  const std::lock_guard lock(thread_mutex_);
  if (state().phase != Phase::kIdle)
    return Error{ErrorCode::kData, "the room is being scanned already: cancel that first"};
  const fs::path rooms = session_.scene.path.parent_path() / kRooms;
  const std::string name = wanted.name.empty() ? free_room_name(rooms) : wanted.name;
  if (fs::exists(rooms / name))
    return Error{ErrorCode::kUsage, "there is a room \"" + name + "\": give another name"};
  if (thread_.joinable()) thread_.join();
  stop_ = cancelled_ = false;
  {
    const std::lock_guard state_lock(mutex_);
    state_ = {};
    state_.phase = Phase::kSweeping, state_.name = name;
  }
  thread_ = std::thread([this, wanted, folder = rooms / name] { work(wanted, folder); });
  return {};
}

Result<void> RoomSweep::cancel() {
  if (state().phase != Phase::kSweeping)
    return Error{ErrorCode::kData,
                 state().phase == Phase::kIdle
                     ? "the room is not being scanned"
                     : "all views are taken, and the room is being built from them"};
  cancelled_ = stop_ = true;
  return {};
}

void RoomSweep::set_phase(Phase phase) {
  const std::lock_guard lock(mutex_);
  state_.phase = phase;
}

void RoomSweep::work(const page::StartSweep& wanted, const fs::path& folder) {
  lower_thread_priority();
  const Result<void> made = guarded("scanning the room", [&] { return make_room(wanted, folder); });
  std::error_code ignored;
  if (made || cancelled_) fs::remove_all(sweep_folder(folder), ignored);
  const std::lock_guard lock(mutex_);
  state_.phase = Phase::kIdle;
  if (made && !stop_) state_.folder = folder.string();
  if (cancelled_) return log_info("session", "the scan of the room was cancelled");
  if (made) return;
  state_.error = to_line(made.error());
  log_warning("session", "the room was not scanned: " + state_.error);
}

/// Holds the cameras' automatic values from now on, so that the views look alike: setting a value
/// ends its automatic control.
void RoomSweep::hold_colors() const {
  if (!session_.cameras) return;
  const auto cameras = session_.cameras->cameras();
  if (cameras.empty()) return;
  for (const live::CameraSetting& setting : cameras.front().settings) {
    if (!setting.value) continue;
    const auto held =
        session_.cameras->set(cameras.front().name, setting.range.control, *setting.value);
    if (!held) log_warning("session", "scan: " + to_line(held.error()));
  }
}

Result<void> RoomSweep::make_room(const page::StartSweep& wanted, const fs::path& folder) {
  fs::create_directories(folder.parent_path());
  LiveScanOptions options;
  options.rig = session_.source->info().file, options.calibration = session_.calibration.file;
  options.out = folder, options.bracket = false;
  options.field_deg = {static_cast<int>(wanted.field_deg.x()),
                       static_cast<int>(wanted.field_deg.y())};
  options.view_frames = wanted.view_frames;
  options.planned = [this](const LiveScan& plan) {
    const std::lock_guard lock(mutex_);
    state_.done = plan.views, state_.total = plan.planned;
  };
  options.progress = [this](int done, int views, Duration left) {
    const std::lock_guard lock(mutex_);
    state_.done = done, state_.total = views, state_.left_s = seconds(left);
  };
  LiveScan scan;
  {
    HeadPlace place(*session_.rig);
    MIXRIG_TRY(place.find(stop_, clock_));
    hold_colors();
    MIXRIG_ASSIGN(scan, sweep_room_of_run(options, *session_.rig, stop_, clock_));
  }
  if (stop_) return {};
  set_phase(Phase::kModelling);
  log_info("session", fmt::format("{} views of the room in {:.0f} s: it is being modelled",
                                  scan.views, scan.seconds));
  RoomScanOptions model;
  model.take = scan.sweep, model.calibration = scan.calibration;
  model.field_deg = options.field_deg;
  MIXRIG_ASSIGN(const RoomScan room, scan_room(model));
  MIXRIG_TRY(save_room(room, scan.calibration, folder));
  MIXRIG_TRY(scene_.use_background(fs::path(kRooms) / folder.filename()));
  log_warning("session", "the room was scanned into " + folder.string() +
                             ": it is the background from the next start on");
  return {};
}

}  // namespace mixrig::session
