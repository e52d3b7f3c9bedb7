// SPDX-License-Identifier: Apache-2.0
#include "host/room/sweep/live_scan.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "hal/base/log.h"
#include "hal/base/partial_path.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/live/rig/held_controls.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/sweep/bracket.h"
#include "host/capture/live/sweep/sweep_rig.h"
#include "host/capture/open/open_source.h"
#include "host/capture/take/growing_take.h"
#include "host/math/config/table.h"
#include "host/room/scan/sweep_plan.h"
#include "host/room/sweep/sweep_file.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostControls_bytes = 4096;
constexpr Duration kAdjusting = std::chrono::seconds(1);

/// The rig, reduced to what a sweep uses, and its calibration.
struct SweepSetup {
  live::RigConfig rig;
  fs::path calibration_path;
  geometry::CameraModel target, tof;
};

Result<geometry::CameraModel> pinhole_of(const calibration_file::Calibration& known,
                                         const char* name, const fs::path& file) {
  const calibration_file::CalibratedCamera* camera = known.camera(name);
  const auto* model =
      camera == nullptr ? nullptr : std::get_if<geometry::CameraModel>(&camera->model);
  if (model == nullptr)
    return Error{ErrorCode::kFormat, fmt::format("'{}' has no pinhole camera \"{}\": run mixrig "
                                                 "calibrate rig",
                                                 file.string(), name)};
  return *model;
}

Result<void> check_rig(const live::RigConfig& rig, const fs::path& file) {
  const auto lacks = [&](const char* what, const char* table) {
    return Error{ErrorCode::kUsage, fmt::format("'{}' has no {}: a scan turns one: add {}",
                                                file.string(), what, table)};
  };
  if (rig.cameras.empty()) return lacks("camera", "[[camera]] with its uri");
  if (!rig.depth) return lacks("depth camera", "[depth] with its uri");
  if (rig.pan_tilt_uri.empty()) return lacks("pan-tilt unit", "[pan_tilt] with its uri");
  return {};
}

Result<SweepSetup> sweep_setup(const LiveScanOptions& options) {
  SweepSetup setup;
  MIXRIG_ASSIGN(setup.rig, live::read_rig(options.rig));
  MIXRIG_TRY(check_rig(setup.rig, options.rig));
  leave_out_cameras(setup.rig, true);
  setup.rig = without_idle_trigger(std::move(setup.rig));
  if (!options.calibration.empty()) setup.rig.calibration = options.calibration;
  setup.calibration_path = setup.rig.calibration;
  if (setup.calibration_path.empty())
    return Error{ErrorCode::kUsage, "'" + options.rig.string() +
                                        "' names no calibration: add calibration = "
                                        "\"calibration.toml\", or give --calibration"};
  MIXRIG_ASSIGN(const auto known, calibration_file::read_calibration(setup.calibration_path));
  if (!known.pan_tilt)
    return Error{ErrorCode::kFormat, "'" + setup.calibration_path.string() +
                                         "' has no pan-tilt unit: run mixrig calibrate ptu"};
  MIXRIG_ASSIGN(setup.target, pinhole_of(known, "target", setup.calibration_path));
  MIXRIG_ASSIGN(setup.tof, pinhole_of(known, "tof", setup.calibration_path));
  return setup;
}

Result<void> check_sizes(const SweepSetup& setup, const live::SweepFacts& facts) {
  const auto same = [&](const char* name, Size known, Size used) -> Result<void> {
    if (known == used) return {};
    return Error{ErrorCode::kFormat,
                 fmt::format("'{}': cameras.{} is of pictures of {}x{}, the device gives {}x{}: "
                             "calibrate at the size that is used",
                             setup.calibration_path.string(), name, known.width, known.height,
                             used.width, used.height)};
  };
  MIXRIG_TRY(same("target", setup.target.size_px(), facts.color_px));
  return same("tof", setup.tof.size_px(), facts.depth_px);
}

Result<model::SweepPlan> plan_for(const LiveScanOptions& options, const SweepSetup& setup,
                                  const device::PanTiltInfo& unit) {
  if (!(unit.minimum.pan_rad <= 0 && unit.maximum.pan_rad >= 0 && unit.minimum.tilt_rad <= 0 &&
        unit.maximum.tilt_rad >= 0))
    return Error{ErrorCode::kDevice,
                 unit.uri + ": its limits leave out pan 0 or tilt 0: reset them in the unit"};
  const geometry::Pinhole& tof = setup.tof.pinhole;
  model::SweepTask task;
  task.field_pan_rad = options.field_deg.width * kDeg;
  task.field_tilt_rad = options.field_deg.height * kDeg;
  task.camera_pan_rad = 2 * std::atan(0.5 * tof.size_px.width / tof.fx_px);
  task.camera_tilt_rad = 2 * std::atan(0.5 * tof.size_px.height / tof.fy_px);
  task.overlap = options.overlap;
  task.most_views = options.most_views;
  task.most_pan_rad = std::min(-unit.minimum.pan_rad, unit.maximum.pan_rad);
  task.most_tilt_rad = unit.maximum.tilt_rad;
  task.most_down_rad = -unit.minimum.tilt_rad;
  return model::plan_sweep(task);
}

/// The folder that holds the room must be free before the head turns for minutes.
Result<void> check_out(const fs::path& out) {
  MIXRIG_ASSIGN(const PartialPath writable, make_partial_folder(out, "manifest.toml"));
  return {};
}

Result<SweepIdentity> identity_of(const LiveScanOptions& options, const SweepSetup& setup) {
  SweepIdentity identity;
  calibration_file::InputHash rig, calibration;
  MIXRIG_TRY(rig.add_file(options.rig));
  MIXRIG_TRY(calibration.add_file(setup.calibration_path));
  identity.rig = rig.text(), identity.calibration = calibration.text();
  identity.field_deg = options.field_deg, identity.overlap = options.overlap;
  identity.view_frames = options.view_frames;
  return identity;
}

/// Automatic control would give each view an exposure and a white balance of its own. After a
/// second of frames what it has found is held, also for a run that goes on with this sweep.
Result<void> hold_colors(const SweepSetup& setup, live::Devices& devices, live::LiveSweepRig& rig,
                         const fs::path& sweep, const std::atomic<bool>& stop, Clock& clock) {
  const live::CameraConfig& config = setup.rig.cameras.front();
  device::Camera& camera = *devices.cameras.front();
  if (!live::adjusts_itself(config, camera.info())) return {};
  const fs::path file = sweep / "controls.toml";
  live::HeldControls earlier;
  std::error_code error;
  if (fs::exists(file, error)) {
    MIXRIG_ASSIGN(const std::string text, config::read_text(file, kMostControls_bytes));
    MIXRIG_ASSIGN(earlier, live::parse_held(text, file.string()));
  } else {
    capture::Capture frame;
    HostTime exposed_from{};
    for (const HostTime end = clock.now() + kAdjusting; clock.now() < end && !stop;)
      if (const auto there = rig.next(end - clock.now(), frame, exposed_from); !there)
        return there.error();
  }
  return write_file(file, live::held_text(live::hold_controls(config, camera, earlier)));
}

/// Control of the other exposures; nullopt, with a warning, where the camera cannot be controlled.
std::optional<live::ExposureBracket> bracket_of(device::Camera& camera,
                                                const live::LiveSweepRig& rig) {
  auto bracket = live::ExposureBracket::create(camera, rig.color_period());
  if (bracket) return *std::move(bracket);
  log_warning("scan", to_line(bracket.error()) +
                          ": the room keeps the light of one exposure, what saturates stays white");
  return {};
}

/// A sweep whose folder is there.
struct BegunSweep {
  LiveScan scan;
  model::SweepPlan plan;
  take::GrowingTake take;
};

Result<BegunSweep> begin_sweep(const LiveScanOptions& options, const SweepSetup& setup,
                               SweepIdentity identity, const live::SweepFacts& facts) {
  MIXRIG_TRY(check_sizes(setup, facts));
  MIXRIG_ASSIGN(model::SweepPlan plan, plan_for(options, setup, facts.unit));
  for (const model::HeadView& view : plan.views)
    identity.views_rad.insert(identity.views_rad.end(), {view.pan_rad, view.tilt_rad});
  LiveScan scan;
  scan.sweep = sweep_folder(options.out), scan.calibration = setup.calibration_path;
  MIXRIG_TRY(begin_or_resume(scan.sweep, identity));
  MIXRIG_ASSIGN(take::GrowingTake take, take::GrowingTake::open(scan.sweep, facts.take));
  scan.planned = static_cast<int>(plan.views.size());
  scan.views = scan.resumed = take.frames() / options.view_frames;
  scan.covered_share = plan.covered_share;
  if (options.planned) options.planned(scan);
  return BegunSweep{std::move(scan), std::move(plan), std::move(take)};
}

live::SweepOptions sweep_options(const LiveScanOptions& options, BegunSweep& begun) {
  live::SweepOptions sweep;
  sweep.settings.view_frames = options.view_frames;
  for (const model::HeadView& view : begun.plan.views)
    sweep.views.push_back({view.pan_rad, view.tilt_rad});
  sweep.first = static_cast<std::size_t>(begun.scan.views);
  sweep.progress = [&options, planned = begun.scan.planned](std::size_t done, Duration left) {
    if (options.progress) options.progress(static_cast<int>(done), planned, left);
  };
  sweep.save = [&begun](std::span<const capture::Capture> frames, device::PanTiltAngles at,
                        std::span<const capture::BracketPlate> plates) -> Result<void> {
    return begun.take.append(frames, at, plates);
  };
  return sweep;
}

Result<LiveScan> ended_sweep(const LiveScanOptions& options, BegunSweep& begun,
                             const Result<live::SweepReport>& swept) {
  LiveScan& scan = begun.scan;
  scan.views = begun.take.frames() / options.view_frames;
  if (swept) {
    scan.bracketed = swept->bracketed, scan.restarts = swept->restarts;
    scan.stopped = swept->stopped;
    return std::move(scan);
  }
  Error error = swept.error();
  error.context += fmt::format(
      " ({} of {} views are in '{}'; the same command goes on with the "
      "next)",
      scan.views, scan.planned, scan.sweep.string());
  return error;
}

/// Runs the devices from view `scan.views` on.
Result<LiveScan> sweep_with(live::Devices& devices, const SweepSetup& setup,
                            const LiveScanOptions& options, BegunSweep& begun,
                            const std::atomic<bool>& stop, Clock& clock) {
  live::SweepOptions sweep = sweep_options(options, begun);
  live::LiveSession session(setup.rig, devices, clock);
  MIXRIG_TRY(session.start());
  const HostTime begin = clock.now();
  live::LiveSweepRig rig(setup.rig, devices, session);
  MIXRIG_TRY(hold_colors(setup, devices, rig, begun.scan.sweep, stop, clock));
  std::optional<live::ExposureBracket> bracket =
      options.bracket ? bracket_of(*devices.cameras.front(), rig) : std::nullopt;
  if (bracket)
    sweep.bracket = [&](const Image<Rgb8>& plate) {
      return bracket->take(rig, plate, stop, clock);
    };
  const auto swept = live::run_sweep(rig, sweep, stop, clock);
  bracket.reset();  // puts the exposure back, whatever ended the sweep
  session.stop();
  begun.scan.seconds = seconds(clock.now() - begin);
  return ended_sweep(options, begun, swept);
}

/// Checks the output and the sweep's folder before devices are opened.
Result<SweepIdentity> check_sweep(const LiveScanOptions& options, const SweepSetup& setup) {
  MIXRIG_TRY(check_out(options.out));
  MIXRIG_ASSIGN(SweepIdentity identity, identity_of(options, setup));
  MIXRIG_TRY(check_sweep_folder(sweep_folder(options.out), identity));
  return identity;
}

}  // namespace

fs::path sweep_folder(const fs::path& out) {
  fs::path folder = out.has_filename() ? out : out.parent_path();
  folder += ".sweep";
  return folder;
}

Result<LiveScan> sweep_room(const LiveScanOptions& options, const std::atomic<bool>& stop,
                            Clock& clock) {
  MIXRIG_ASSIGN(const SweepSetup setup, sweep_setup(options));
  MIXRIG_ASSIGN(SweepIdentity identity, check_sweep(options, setup));
  MIXRIG_ASSIGN(live::Devices devices,
                live::open_devices(setup.rig, device_opener(setup.rig, options.kinds, clock)));
  MIXRIG_ASSIGN(const live::SweepFacts facts, live::sweep_facts(setup.rig, devices));
  MIXRIG_ASSIGN(BegunSweep begun, begin_sweep(options, setup, std::move(identity), facts));
  if (begun.scan.views >= begun.scan.planned) return std::move(begun.scan);
  return sweep_with(devices, setup, options, begun, stop, clock);
}

Result<LiveScan> sweep_room_of_run(const LiveScanOptions& options, live::RunningRig& rig,
                                   const std::atomic<bool>& stop, Clock& clock) {
  MIXRIG_ASSIGN(const SweepSetup setup, sweep_setup(options));
  MIXRIG_ASSIGN(SweepIdentity identity, check_sweep(options, setup));
  MIXRIG_ASSIGN(const live::SweepFacts facts, rig.facts());
  MIXRIG_ASSIGN(BegunSweep begun, begin_sweep(options, setup, std::move(identity), facts));
  if (begun.scan.views >= begun.scan.planned) return std::move(begun.scan);
  const live::SweepOptions sweep = sweep_options(options, begun);
  const HostTime begin = clock.now();
  const auto swept = live::run_sweep(rig, sweep, stop, clock);
  begun.scan.seconds = seconds(clock.now() - begin);
  return ended_sweep(options, begun, swept);
}

}  // namespace mixrig::session
