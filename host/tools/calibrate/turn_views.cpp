// SPDX-License-Identifier: Apache-2.0
// Views of a board that stands still, by a rig whose pan-tilt unit turns.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "hal/base/log.h"
#include "host/calibrate/views/turn_plan.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/sweep/sweep_rig.h"
#include "host/capture/open/open_source.h"
#include "host/tools/calibrate/collect_views.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"

namespace mixrig::tools {
namespace {

using calibration::ViewCollector;

constexpr Duration kFirstPatience = std::chrono::seconds(20),
                   kFrameWait = std::chrono::milliseconds(100);
constexpr double kLeastReach_rad = 2 * kDeg;

Result<live::RigConfig> rig_with_unit(const std::filesystem::path& file) {
  MIXRIG_ASSIGN(live::RigConfig rig, live::read_rig(file));
  if (rig.cameras.empty() || !rig.depth || rig.pan_tilt_uri.empty())
    return Error{ErrorCode::kUsage,
                 "'" + file.string() +
                     "': --turn needs a [[camera]], a [depth] camera and a [pan_tilt] unit"};
  session::leave_out_cameras(rig, true);
  return session::without_idle_trigger(std::move(rig));
}

/// The board where the unit stands now: the first view.
Result<ViewCollector> first_view(live::SweepRig& rig, const capture::SourceInfo& info,
                                 const CollectArguments& arguments, const std::atomic<bool>& stop,
                                 Clock& clock) {
  std::optional<ViewCollector> collector;
  capture::Capture capture;
  HostTime exposed_from{};
  for (const HostTime end = clock.now() + kFirstPatience; clock.now() < end && !stop;) {
    MIXRIG_ASSIGN(const bool there, rig.next(kFrameWait, capture, exposed_from));
    if (!there || !capture.pan_tilt) continue;
    if (!collector) {
      MIXRIG_ASSIGN(collector,
                    ViewCollector::create(arguments.out, info, capture, arguments.settings));
    }
    MIXRIG_ASSIGN(const auto state, collector->add(capture));
    if (state == calibration::CollectState::kKept) return *std::move(collector);
  }
  if (stop) return Error{ErrorCode::kDevice, "stopped before the first view"};
  if (!collector)
    return Error{ErrorCode::kTimeout,
                 "no frames with an angle of the pan-tilt unit came: run mixrig diag"};
  return collector->why_none("");
}

Result<device::PanTiltAngles> reach_of(const ViewCollector& collector,
                                       const capture::SourceInfo& info,
                                       const CollectArguments& arguments) {
  if (!arguments.turn_deg.empty())
    return device::PanTiltAngles{0.5 * arguments.turn_deg.width * kDeg,
                                 0.5 * arguments.turn_deg.height * kDeg};
  const device::PanTiltAngles reach = calibration::turn_reach(*collector.last()[0], info.target);
  if (std::min(reach.pan_rad, reach.tilt_rad) >= kLeastReach_rad) return reach;
  return Error{ErrorCode::kData,
               "the board leaves no room to turn: put it in the middle of the target picture and "
               "farther away, or give --turn PANxTILT in degrees"};
}

Result<live::SweepReport> sweep(live::SweepRig& rig, const device::PanTiltInfo& unit,
                                const capture::SourceInfo& info, const CollectArguments& arguments,
                                const std::atomic<bool>& stop, Clock& clock,
                                ViewCollector& collector, device::PanTiltAngles home) {
  MIXRIG_ASSIGN(const device::PanTiltAngles reach, reach_of(collector, info, arguments));
  live::SweepOptions options;
  options.settings.view_frames = arguments.settings.frames;
  options.views = calibration::turn_angles(home, reach, arguments.turn_views, unit);
  options.first = 1;  // is there
  Progress bar("views", arguments.turn_views);
  options.progress = [&](std::size_t done, Duration left) {
    bar.step(static_cast<int>(done), seconds(left));
  };
  options.save = [&](std::span<const capture::Capture> frames, device::PanTiltAngles,
                     std::span<const capture::BracketPlate>) -> Result<void> {
    for (const capture::Capture& frame : frames) {
      capture::Capture copy = frame;
      MIXRIG_TRY(collector.add(copy));
    }
    return {};
  };
  return live::run_sweep(rig, options, stop, clock);
}

}  // namespace

Result<nlohmann::json> turn_views(const std::filesystem::path& rig_toml,
                                  const CollectArguments& given, const std::atomic<bool>& stop,
                                  Clock& clock) {
  MIXRIG_ASSIGN(const live::RigConfig config, rig_with_unit(rig_toml));
  MIXRIG_ASSIGN(live::Devices devices,
                live::open_devices(config, session::device_opener(config, source_kinds(), clock)));
  MIXRIG_ASSIGN(const take::TakeInfo info, live::take_info(config, devices));
  const device::PanTiltInfo unit = devices.pan_tilt->info();
  CollectArguments arguments = given;
  arguments.settings.every_place = true;
  arguments.settings.still_time = Duration(0);  // the sweep's frames are those of one standstill
  arguments.settings.step_rad = unit.resolution.pan_rad;
  MIXRIG_ASSIGN(const device::PanTiltSample start, devices.pan_tilt->sample());
  live::LiveSession session(config, devices, clock);
  MIXRIG_TRY(session.start());
  live::LiveSweepRig rig(config, devices, session);
  MIXRIG_ASSIGN(ViewCollector collector, first_view(rig, info, arguments, stop, clock));
  const auto swept = sweep(rig, unit, info, arguments, stop, clock, collector, start.angles);
  if (swept || swept.error().code != ErrorCode::kDevice) (void)rig.move_to(start.angles);
  session.stop();
  if (!swept) return finish_views(collector, arguments, "error", &swept.error());
  const int lost = static_cast<int>(swept->views) - collector.folder().views();
  if (lost > 0)
    log_warning("views", fmt::format("{} of {} views do not show the whole board and are left out",
                                     lost, swept->views));
  return finish_views(collector, arguments, swept->stopped ? "stopped" : "all views", nullptr);
}

}  // namespace mixrig::tools
