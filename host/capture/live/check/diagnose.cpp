// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/check/diagnose.h"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host/capture/live/check/grey_card.h"
#include "host/capture/live/rig/depth_phases.h"
#include "host/capture/live/rig/devices.h"

namespace mixrig::live {
namespace {

constexpr double kDiskWarn_gb = 20, kDiskFail_gb = 1;
constexpr double kMove_rad = 0.05;  // about 3 degrees: measurable, and it needs little room
constexpr int kVisits = 4;
constexpr Duration kMoveTimeout = std::chrono::seconds(5);
constexpr double kHot_c = 70, kTooHot_c = 85, kDark = 20;

/// Adds a check: passed if the device was opened, else the error of opening it.
template <typename T>
bool check_open(const std::string& device, Result<T>& opened, std::vector<Check>& checks) {
  if (opened)
    checks.push_back({device, "open", Verdict::kPass, "yes", ""});
  else
    checks.push_back({device, "open", Verdict::kFail, "no", to_line(opened.error())});
  return opened.has_value();
}

/// The devices that could be opened: `config` names exactly those in `devices`.
struct OpenedRig {
  RigConfig config;
  Devices devices;
  bool target_open = false;
};

/// Reports what a depth step is, where the number comes from, and what else rig.toml changes.
Check check_steps(const RigConfig& rig, const std::string& name, const DepthConfig& given,
                  const device::DepthCamera& camera) {
  const device::DepthInfo steps = given.applied_to(camera.depth());
  std::string value =
      fmt::format("{:.6g} mm a step ({}), {}", steps.metres_per_step * 1e3,
                  given.unit_m ? "rig.toml" : "camera",
                  steps.meaning == device::DepthMeaning::kZ ? "along z" : "along the ray");
  if (steps.offset_m != 0) value += fmt::format(", {:+.1f} mm", steps.offset_m * 1e3);
  if (const auto known = check_unit(rig, camera, &given); !known)
    return {name, "unit", Verdict::kFail, "not known", to_line(known.error())};
  return {name, "unit", Verdict::kPass, std::move(value), ""};
}

/// Reports what synchronizes a camera's clock, if it can be PTP.
void add_ptp(const std::string& name, const device::CameraInfo& info, std::vector<Check>& checks) {
  if (info.ptp.empty()) return;
  const bool settled = info.ptp == "off" || info.ptp == "Slave" || info.ptp == "Master";
  checks.push_back({name, "ptp", settled ? Verdict::kPass : Verdict::kWarn, info.ptp,
                    settled ? "" : "wait until the camera follows a PTP master, or turn PTP off"});
}

/// Opens a depth camera and adds a check; null if it cannot be opened.
std::unique_ptr<device::DepthCamera> open_depth(const RigConfig& rig, const CameraConfig& config,
                                                const DepthConfig& steps, DeviceOpener& opener,
                                                std::vector<Check>& checks) {
  auto depth = opener.depth(config.uri, config.request);
  if (!check_open(config.name, depth, checks)) return nullptr;
  add_ptp(config.name, (*depth)->info(), checks);
  checks.push_back(check_steps(rig, config.name, steps, **depth));
  return *std::move(depth);
}

OpenedRig open_each(const RigConfig& rig, DeviceOpener opener, std::vector<Check>& checks) {
  OpenedRig out{rig, {}, false};
  out.config.cameras.clear();
  out.config.depth.reset(), out.config.depth2.reset();
  if (!rig.trigger_uri.empty()) {
    auto trigger = opener.trigger(rig.trigger_uri);
    if (check_open("trigger", trigger, checks)) out.devices.trigger = *std::move(trigger);
  }
  if (!rig.edges_uri.empty()) {
    auto edges = opener.edges(rig.edges_uri);
    // Without the master that rig.toml names, the cameras that run free are judged by the host's
    // time.
    const bool wanted = rig.trigger_uri.empty() || out.devices.trigger;
    if (check_open("trigger_edges", edges, checks) && wanted) out.devices.edges = *std::move(edges);
  }
  for (const CameraConfig& config : rig.cameras) {
    auto camera = opener.camera(config.uri, config.request);
    if (camera)
      if (auto applied = apply_controls(config, **camera); !applied)
        camera = std::move(applied).error();
    if (!check_open(config.name, camera, checks)) continue;
    add_ptp(config.name, (*camera)->info(), checks);
    out.target_open |= &config == rig.cameras.data();
    out.config.cameras.push_back(config);
    out.devices.cameras.push_back(*std::move(camera));
  }
  if (rig.depth) out.devices.depth = open_depth(rig, *rig.depth, rig.depth_steps, opener, checks);
  if (out.devices.depth) out.config.depth = rig.depth;
  if (rig.depth2) {
    auto second = open_depth(rig, *rig.depth2, rig.depth2_steps, opener, checks);
    // A second depth camera alone is judged in place of the first.
    const bool alone = !out.devices.depth;
    if (second) (alone ? out.config.depth : out.config.depth2) = rig.depth2;
    (alone ? out.devices.depth : out.devices.depth2) = std::move(second);
    const DepthPhases phases = depth_phases(rig);
    checks.push_back({rig.depth2->name, "phase", phases.known ? Verdict::kPass : Verdict::kWarn,
                      phases.known ? phases.line : "not known", phases.known ? "" : phases.line});
  }
  if (!rig.pan_tilt_uri.empty()) {
    auto head = opener.pan_tilt(rig.pan_tilt_uri);
    if (check_open("pan_tilt", head, checks)) out.devices.pan_tilt = *std::move(head);
  }
  return out;
}

Result<std::vector<device::PanTiltAngles>> visit(device::PanTilt& head, Clock& clock) {
  std::vector<device::PanTiltAngles> positions;
  MIXRIG_ASSIGN(const device::PanTiltSample home, head.sample());
  for (int i = 0; i < kVisits; ++i) {
    // It moves towards the middle of the range, so that no limit is near.
    const double pan_away = home.angles.pan_rad > 0 ? -kMove_rad : kMove_rad;
    const double tilt_away = home.angles.tilt_rad > 0 ? -kMove_rad : kMove_rad;
    const device::PanTiltAngles away{home.angles.pan_rad + pan_away,
                                     home.angles.tilt_rad + tilt_away};
    MIXRIG_TRY(head.move_to(away));
    MIXRIG_TRY(device::await_position(head, away, clock, kMoveTimeout));
    MIXRIG_TRY(head.move_to(home.angles));
    MIXRIG_TRY(device::await_position(head, home.angles, clock, kMoveTimeout));
    MIXRIG_ASSIGN(const device::PanTiltSample back, head.sample());
    positions.push_back(back.angles);
  }
  return positions;
}

void check_head(device::PanTilt& head, Clock& clock, std::vector<Check>& checks) {
  const auto positions = visit(head, clock);
  if (!positions) {
    checks.push_back(
        {"pan_tilt", "repeatability", Verdict::kFail, "not measured", to_line(positions.error())});
    return;
  }
  checks.push_back(judge_repeatability(*positions, head.info().resolution));
  const auto health = head.health();
  std::string value = fmt::format("{} timeouts, {} noise bytes, {} limit hits", health.timeouts,
                                  health.noise_bytes, health.limit_hits);
  const bool bad = health.timeouts > 0 || health.noise_bytes > 0 || health.limit_hits > 0;
  checks.push_back({"pan_tilt", "link", bad ? Verdict::kWarn : Verdict::kPass, std::move(value),
                    bad ? "check the serial cable and the range of the head" : ""});
}

void check_depth(const std::string& name, const device::DepthHealth& health,
                 std::vector<Check>& checks) {
  if (std::isfinite(health.temperature_c)) {
    const Verdict verdict = health.temperature_c > kTooHot_c ? Verdict::kFail
                            : health.temperature_c > kHot_c  ? Verdict::kWarn
                                                             : Verdict::kPass;
    checks.push_back({name, "temperature", verdict,
                      fmt::format("{:.1f} degrees", health.temperature_c),
                      verdict == Verdict::kPass ? "" : "improve the cooling of the ToF camera"});
  }
  if (!std::isfinite(health.mean_amplitude)) return;
  const bool dark = health.mean_amplitude < kDark;
  checks.push_back(
      {name, "amplitude", dark ? Verdict::kWarn : Verdict::kPass,
       fmt::format("{:.0f} of 65535", health.mean_amplitude),
       dark ? "hardly any light returns: check the lens and what is in front of it" : ""});
}

void check_trigger(const SessionReport& report, device::TriggerMaster& trigger,
                   std::vector<Check>& checks) {
  const bool none = report.ticks == 0;
  const bool some =
      report.ticks_lost > 0 || report.trigger_errors > 0 || report.trigger_restarts > 0;
  checks.push_back(
      {"trigger", "ticks",
       none   ? Verdict::kFail
       : some ? Verdict::kWarn
              : Verdict::kPass,
       fmt::format("{} ticks, {} lost, {} errors", report.ticks, report.ticks_lost,
                   report.trigger_errors),
       none || some ? "check the line to the trigger board: mixrig trigger status" : ""});
  const bool off = std::abs(report.trigger_drift_ppm) > 200;
  checks.push_back({"trigger", "clock", off ? Verdict::kWarn : Verdict::kPass,
                    fmt::format("{:.1f} ppm", report.trigger_drift_ppm),
                    off ? "the board runs from its internal oscillator: check the crystal" : ""});
  const auto status = trigger.status();
  if (!status) return;
  const bool late = status->late_max > std::chrono::milliseconds(1);
  checks.push_back(
      {"trigger", "jitter", late ? Verdict::kWarn : Verdict::kPass,
       fmt::format("{:.3f} ms late at most", milliseconds(status->late_max)),
       late ? "give the software trigger real-time priority, or use a trigger board" : ""});
}

double nominal_rate(const RigConfig& config, const CameraConfig& camera, double reported_hz,
                    bool trigger) {
  const TriggerLine* line = config.line_of(camera);
  return trigger && line != nullptr ? 100.0 / line->channel.divider : reported_hz;
}

double edge_rate_hz(const RigConfig& config) {
  const TriggerLine* line = config.line(config.edges_line);
  return line != nullptr ? 100.0 / line->channel.divider : 0;
}

/// Adds the checks on a grey card for the target camera, which is the session's first.
void add_card(OpenedRig& rig, const DiagnoseOptions& options, LiveSession& session, Clock& clock,
              std::vector<Check>& checks) {
  const NextFrame next = [&]() -> Result<device::FramePtr> {
    if (session.ended())
      return Error{ErrorCode::kDevice, "the cameras have ended before the card was judged"};
    const auto set = session.next(std::chrono::milliseconds(100));
    return set ? set->frames.frames[0].frame : nullptr;
  };
  for (Check& check : check_card(rig.config.cameras.front(), *rig.devices.cameras.front(),
                                 options.card_area, next, clock))
    checks.push_back(std::move(check));
}

void watch(OpenedRig& rig, const DiagnoseOptions& options, Clock& clock,
           std::vector<Check>& checks) {
  LiveSession session(rig.config, rig.devices, clock);
  if (auto started = session.start(); !started) {
    checks.push_back({"host", "session", Verdict::kFail, "not started", to_line(started.error())});
    return;
  }
  const HostTime begin = clock.now();
  while (clock.now() - begin < options.watch) (void)session.next(std::chrono::milliseconds(100));
  const SessionReport report = session.report();
  const double watched_s = seconds(clock.now() - begin);
  if (rig.devices.trigger) check_trigger(report, *rig.devices.trigger, checks);
  if (rig.devices.edges)
    checks.push_back(judge_edges(report.edges, edge_rate_hz(rig.config), watched_s,
                                 rig.devices.trigger != nullptr));
  const bool trigger = rig.devices.trigger != nullptr || rig.devices.edges != nullptr;
  for (std::size_t i = 0; i < report.streams.size(); ++i) {
    const std::size_t cameras = rig.devices.cameras.size();
    const CameraConfig& config = i < cameras    ? rig.config.cameras[i]
                                 : i == cameras ? *rig.config.depth
                                                : *rig.config.depth2;
    const double reported_hz = i < cameras    ? rig.devices.cameras[i]->info().rate_hz
                               : i == cameras ? rig.devices.depth->info().rate_hz
                                              : rig.devices.depth2->info().rate_hz;
    const bool triggered = trigger && config.trigger_line >= 0;
    for (Check& check :
         judge_stream(report.streams[i], nominal_rate(rig.config, config, reported_hz, trigger),
                      watched_s, triggered))
      checks.push_back(std::move(check));
  }
  if (rig.devices.depth)
    check_depth(rig.config.depth->name, rig.devices.depth->depth_health(), checks);
  if (rig.devices.depth2)
    check_depth(rig.config.depth2->name, rig.devices.depth2->depth_health(), checks);
  if (options.grey_card && rig.target_open) add_card(rig, options, session, clock, checks);
  session.stop();
}

void check_disk(const std::filesystem::path& path, std::vector<Check>& checks) {
  std::error_code error;
  const auto space = std::filesystem::space(path, error);
  const double free_gb = error ? 0 : static_cast<double>(space.available) / 1e9;
  const Verdict verdict = free_gb < kDiskFail_gb   ? Verdict::kFail
                          : free_gb < kDiskWarn_gb ? Verdict::kWarn
                                                   : Verdict::kPass;
  checks.push_back({"host", "disk", verdict, fmt::format("{:.1f} GB free", free_gb),
                    verdict == Verdict::kPass ? "" : "free disk space before recording"});
}

}  // namespace

std::vector<Check> diagnose(const RigConfig& rig, DeviceOpener opener,
                            const DiagnoseOptions& options, Clock& clock) {
  std::vector<Check> checks;
  OpenedRig opened = open_each(rig, std::move(opener), checks);
  if (checks.empty())
    checks.push_back({"host", "devices", Verdict::kFail, "none",
                      "nothing is connected, or the user may not open devices: install "
                      "70-mixrig.rules in /etc/udev/rules.d"});
  if (opened.devices.pan_tilt && options.move_head)
    check_head(*opened.devices.pan_tilt, clock, checks);
  if (!opened.devices.cameras.empty() || opened.devices.depth)
    watch(opened, options, clock, checks);
  if (options.grey_card && !opened.target_open)
    checks.push_back({"host", "card", Verdict::kFail, "not measured",
                      "the target camera could not be opened: see its line in this table"});
  check_disk(options.disk, checks);
  return checks;
}

}  // namespace mixrig::live
