// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/frame_lens.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/math/geometry/lens_table.h"

namespace mixrig::session {

std::optional<geometry::LensState> frame_lens(const capture::Capture& capture) {
  return capture.lens ? std::optional(capture.lens->state) : std::nullopt;
}

geometry::Pinhole frame_view(const render::CompositorSetup& setup,
                             const capture::Capture& capture) {
  return capture.lens ? render::view_through(setup, capture.lens->state.camera.pinhole)
                      : setup.view;
}

geometry::Pose world_from_pupil(const geometry::Pose& world_from_target,
                                const capture::Capture& capture) {
  return capture.lens ? geometry::at_pupil(world_from_target, capture.lens->state.pupil_shift_m)
                      : world_from_target;
}

/// Whether the view reaches beyond the learned one: a far point in one of its corners lies outside
/// of it by more than a fiftieth of its size.
bool LensWatch::beyond(const capture::Capture& capture,
                       const geometry::Pose& world_from_target) const {
  constexpr double kFar_m = 1e3, kMargin = 0.02;
  if (learned_ == nullptr || !learned_->world_from_view) return false;
  const geometry::Pinhole view = frame_view(setup_, capture);
  const geometry::Pose learned_from_view =
      geometry::inverse(*learned_->world_from_view) * world_from_pupil(world_from_target, capture);
  const Size size = learned_->view.size_px;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(view.size_px.width - 1, 0),
        Eigen::Vector2d(0, view.size_px.height - 1),
        Eigen::Vector2d(view.size_px.width - 1, view.size_px.height - 1)}) {
    const Eigen::Vector2d ray = view.unproject(corner);
    const Eigen::Vector3d p = learned_from_view * (kFar_m * ray.homogeneous());
    if (!(p.z() > 0)) return true;
    const Eigen::Vector2d px = learned_->view.project(p);
    if (px.x() < -kMargin * size.width || px.y() < -kMargin * size.height ||
        px.x() > (1 + kMargin) * size.width || px.y() > (1 + kMargin) * size.height)
      return true;
  }
  return false;
}

void LensWatch::warn(capture::LensOrigin origin, const capture::Capture& capture) {
  if (std::exchange(warned_[static_cast<std::size_t>(origin)], true)) return;
  if (origin == capture::LensOrigin::kClamped)
    log_warning("session",
                fmt::format("frame {}: zoom {:g}, focus {:g} of the lens lie outside its "
                            "calibrated table: its border is used; calibrate more settings",
                            capture.number, capture.encoders->zoom, capture.encoders->focus));
  if (origin == capture::LensOrigin::kHeld)
    log_warning("session",
                fmt::format("frame {}: the encoders of the lens say nothing near mid-exposure: the "
                            "last lens is kept",
                            capture.number));
}

void LensWatch::add(const capture::Capture& capture, const geometry::Pose& world_from_target) {
  if (!capture.lens) return;
  const geometry::Pinhole& pinhole = capture.lens->state.camera.pinhole;
  if (!report_) {
    report_.emplace();
    report_->least_fx_px = report_->most_fx_px = pinhole.fx_px;
  }
  LensReport& report = *report_;
  const capture::LensOrigin origin = capture.lens->origin;
  ++report.frames[static_cast<std::size_t>(origin)];
  report.changed += last_ && !(*last_ == pinhole);
  last_ = pinhole;
  report.least_fx_px = std::min(report.least_fx_px, pinhole.fx_px);
  report.most_fx_px = std::max(report.most_fx_px, pinhole.fx_px);
  if (origin != capture::LensOrigin::kEncoded) warn(origin, capture);
  if (!beyond(capture, world_from_target) || report.beyond_background++ > 0) return;
  log_warning("session",
              fmt::format("frame {}: the lens shows more of the room than was learned: nothing is "
                          "known of the background there, and people are keyed worse; learn at "
                          "the widest zoom, or scan the room",
                          capture.number));
}

}  // namespace mixrig::session
