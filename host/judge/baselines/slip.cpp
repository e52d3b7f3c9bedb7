// SPDX-License-Identifier: Apache-2.0
#include "host/judge/baselines/slip.h"

#include <cmath>

#include "host/pose/source/point_covariance.h"

namespace mixrig::session {
namespace {

measure::CameraPlace place_of(const geometry::Pose& world_from_camera) {
  const Eigen::Vector4d q = world_from_camera.rotation.coeffs();
  const Eigen::Vector3d& t = world_from_camera.translation_m;
  return {{q[0], q[1], q[2], q[3]}, {t.x(), t.y(), t.z()}};
}

/// Root mean square of the points of one frame.
class FrameMean {
 public:
  void add(double square_px2) { sum_px2_ += square_px2, ++count_; }
  std::optional<double> rms_px() const {
    return count_ == 0 ? std::nullopt : std::optional(std::sqrt(sum_px2_ / count_));
  }

 private:
  double sum_px2_ = 0;
  int count_ = 0;
};

}  // namespace

SlipWatch::Seen SlipWatch::seen(const Eigen::Vector3d& point_m,
                                const geometry::Pose& world_from_target,
                                const geometry::Pinhole& view) {
  const auto px =
      measure::pixel_of({point_m.x(), point_m.y(), point_m.z()}, place_of(world_from_target),
                        {view.fx_px, view.fy_px, view.cx_px, view.cy_px});
  const auto within = [](double at, int size) { return at >= -0.5 && at <= size - 0.5; };
  return {px, px && within((*px)[0], view.size_px.width) && within((*px)[1], view.size_px.height)};
}

FrameSlip SlipWatch::add(const capture::CameraPose& used,
                         const std::optional<geometry::Pose>& known,
                         const geometry::Pinhole& used_view, const geometry::Pinhole& known_view) {
  FrameMean measured, predicted;
  for (const Eigen::Vector3d& point_m : contacts_m_) {
    const Seen drawn = seen(point_m, used.world_from_target, used_view);
    const Seen real = known ? seen(point_m, *known, known_view) : Seen{};
    if (!drawn.px || !(drawn.inside || real.inside)) continue;
    std::optional<Eigen::Matrix2d> spread;
    if (used.ok() && used.covariance)
      spread = pose::point_covariance(point_m, used.world_from_target, *used.covariance, used_view);
    if (spread) {
      predicted.add(spread->trace());
      predicted_.add(std::sqrt(spread->trace()));
    }
    if (!real.px) continue;
    const measure::PixelPoint error{(*drawn.px)[0] - (*real.px)[0], (*drawn.px)[1] - (*real.px)[1]};
    measured.add(error[0] * error[0] + error[1] * error[1]);
    measured_.add(std::hypot(error[0], error[1]));
    if (!spread) continue;
    ++judged_;
    within_ += measure::within_95_pct(error, {(*spread)(0, 0), (*spread)(1, 1), (*spread)(0, 1)});
  }
  return {measured.rms_px(), predicted.rms_px()};
}

SlipReport SlipWatch::report() const {
  SlipReport report;
  if (measured_.count() > 0)
    report.measured = {measured_.rms_px(), measured_.quantile_px(0.95), measured_.max_px()};
  if (predicted_.count() > 0) report.sigma_px = predicted_.rms_px();
  if (judged_ > 0)
    report.within_95_pct = 100.0 * static_cast<double>(within_) / static_cast<double>(judged_);
  return report;
}

}  // namespace mixrig::session
