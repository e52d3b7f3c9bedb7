// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/sweep/sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hal/base/angles.h"

namespace mixrig::live {
namespace {

constexpr Duration kSweepWait = std::chrono::milliseconds(100);
constexpr double kHalfStep = 0.51, kFinestStep_rad = 1e-5;

/// Returns the larger of the two axes' distances.
double away_from(device::PanTiltAngles a, device::PanTiltAngles b) {
  return std::max(std::abs(a.pan_rad - b.pan_rad), std::abs(a.tilt_rad - b.tilt_rad));
}

bool within_half_a_step(device::PanTiltAngles a, device::PanTiltAngles b,
                        device::PanTiltAngles step) {
  const auto near = [](double x, double y, double size) {
    return std::abs(x - y) <= kHalfStep * std::max(size, kFinestStep_rad);
  };
  return near(a.pan_rad, b.pan_rad, step.pan_rad) && near(a.tilt_rad, b.tilt_rad, step.tilt_rad);
}

bool is_fresh(const capture::Capture& frame) {
  return frame.status_of(capture::Stream::kDepth) != capture::StreamStatus::kRepeated;
}

/// Adds the view to an error.
Error at_view(Error error, const SweepOptions& options, std::size_t view) {
  const device::PanTiltAngles& at = options.views[view];
  error.context =
      fmt::format("view {} of {} (pan {:.1f}, tilt {:.1f} deg): {}", view + 1, options.views.size(),
                  at.pan_rad / kDeg, at.tilt_rad / kDeg, error.context);
  return error;
}

/// Takes one view; false when `stop` was set.
Result<bool> take_view(SweepRig& rig, device::PanTiltAngles target, ViewTaker& taker,
                       capture::Capture& frame, const std::atomic<bool>& stop, Clock& clock) {
  if (auto moving = rig.move_to(target); !moving) {
    Error error = std::move(moving).error();
    error.context = "the pan-tilt unit was not moved: " + error.context;
    return error;
  }
  taker.begin(target, clock.now());
  while (!taker.taken()) {
    if (stop) {
      (void)rig.halt();
      return false;
    }
    HostTime exposed_from{};
    MIXRIG_ASSIGN(const bool there, rig.next(kSweepWait, frame, exposed_from));
    if (there) taker.add(frame, exposed_from, clock.now());
    if (auto fine = taker.check(clock.now()); !fine) {
      if (fine.error().code != ErrorCode::kDevice) (void)rig.halt();  // not sent to a lost unit
      return std::move(fine).error();
    }
  }
  return true;
}

}  // namespace

ViewTaker::ViewTaker(const SweepSettings& settings, device::PanTiltAngles step)
    : settings_(settings),
      step_(step),
      wanted_(static_cast<std::size_t>(std::max(2, settings.view_frames))),
      frames_(wanted_) {}

void ViewTaker::begin(device::PanTiltAngles target, HostTime now) {
  target_ = target;
  count_ = 0;
  first_away_rad_.reset(), away_rad_.reset();
  arrived_.reset(), stands_.reset();
  nearer_ = framed_ = angled_ = now;
  color_shift_ = depth_shift_ = {};
}

void ViewTaker::add(capture::Capture& frame, HostTime exposed_from, HostTime now) {
  framed_ = now;
  if (!frame.pan_tilt) return;
  angled_ = now;
  follow(*frame.pan_tilt, now);
  if (!within_half_a_step(*frame.pan_tilt, target_, step_)) {
    stands_.reset();
    count_ = 0;
    return;
  }
  if (!arrived_) arrived_ = now;
  if (!stands_) stands_ = frame.mid_exposure;
  if (exposed_from < *stands_ || !is_fresh(frame)) return;
  if (count_ > 0 && !agrees(frame)) {
    ++restarts_;
    count_ = 0;
  }
  keep(frame);
}

void ViewTaker::follow(device::PanTiltAngles at, HostTime now) {
  const double away_rad = away_from(at, target_);
  if (!first_away_rad_) first_away_rad_ = away_rad;
  const double least_rad = std::max(kFinestStep_rad, 0.5 * std::min(step_.pan_rad, step_.tilt_rad));
  if (away_rad_ && away_rad > *away_rad_ - least_rad) return;
  away_rad_ = away_rad;
  nearer_ = now;
}

bool ViewTaker::agrees(const capture::Capture& frame) {
  luminance_of(frame.plate, luminance_);
  const PictureShift color = shift_between(reference_, luminance_);
  const PictureShift depth = shift_between(frames_[0].depth_m.view(), frame.depth_m.view());
  if (color.is_none(settings_.rest_px) && depth.is_none(settings_.rest_px)) return true;
  color_shift_ = color, depth_shift_ = depth;
  return false;
}

void ViewTaker::keep(capture::Capture& frame) {
  if (count_ == 0) luminance_of(frame.plate, reference_);
  std::swap(frames_[count_++], frame);
}

std::span<const capture::Capture> ViewTaker::frames() const {
  return std::span(frames_).first(
      std::min(count_, static_cast<std::size_t>(settings_.view_frames)));
}

Error ViewTaker::not_settled() const {
  const double s = seconds(settings_.settle_timeout);
  if (!stands_)
    return {ErrorCode::kTimeout,
            fmt::format("the pan-tilt unit arrived but does not stay there ({:.0f} s): check load, "
                        "balance and power",
                        s)};
  return {ErrorCode::kTimeout,
          fmt::format("the picture does not settle ({:.0f} s): the last shift was {:.2f} px in "
                      "colour and {:.2f} px in depth: check that the stand is firm and that nobody "
                      "fills the view",
                      s, color_shift_.length_px(), depth_shift_.length_px())};
}

Result<void> ViewTaker::check(HostTime now) const {
  if (taken()) return {};
  if (now - framed_ > settings_.frame_timeout)
    return Error{ErrorCode::kTimeout,
                 fmt::format("no frames that could be paired came from the cameras for {:.0f} s: "
                             "run mixrig diag",
                             seconds(settings_.frame_timeout))};
  if (framed_ - angled_ > settings_.angle_timeout)
    return Error{ErrorCode::kDevice,
                 fmt::format("the pan-tilt unit is lost: no angle for {:.0f} s: check its cable "
                             "and power, then run the same command again",
                             seconds(settings_.angle_timeout))};
  if (arrived_) {
    if (now - *arrived_ > settings_.settle_timeout) return not_settled();
    return {};
  }
  if (now - nearer_ <= settings_.move_timeout || !away_rad_) return {};
  const bool moved = *away_rad_ < *first_away_rad_;
  return Error{ErrorCode::kTimeout,
               fmt::format("the pan-tilt unit {} for {:.0f} s, {:.2f} deg away: check limits, load "
                           "and power",
                           moved ? "has not come nearer" : "does not move",
                           seconds(settings_.move_timeout), *away_rad_ / kDeg)};
}

Result<SweepReport> run_sweep(SweepRig& rig, const SweepOptions& options,
                              const std::atomic<bool>& stop, Clock& clock) {
  ViewTaker taker(options.settings, rig.step());
  capture::Capture frame;
  const HostTime begin = clock.now();
  SweepReport report{.views = options.first};
  while (report.views < options.views.size() && !report.stopped) {
    const std::size_t view = report.views;
    auto taken = take_view(rig, options.views[view], taker, frame, stop, clock);
    report.stopped = taken && !*taken;
    if (!taken) return at_view(std::move(taken).error(), options, view);
    if (report.stopped) break;
    std::vector<capture::BracketPlate> bracket;
    if (options.bracket) {
      auto plates = options.bracket(taker.frames().back().plate);
      if (!plates) return at_view(std::move(plates).error(), options, view);
      bracket = *std::move(plates);
      report.stopped = stop;  // there may be too few plates: the view is taken again
      if (report.stopped) break;
    }
    if (auto saved = options.save(taker.frames(), taker.angles(), bracket); !saved)
      return at_view(std::move(saved).error(), options, view);
    if (!bracket.empty()) ++report.bracketed;
    ++report.views;
    const auto done = static_cast<long>(report.views - options.first);
    const auto left = static_cast<long>(options.views.size() - report.views);
    if (options.progress) options.progress(report.views, (clock.now() - begin) / done * left);
  }
  report.restarts = taker.restarts();
  return report;
}

}  // namespace mixrig::live
