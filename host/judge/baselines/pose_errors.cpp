// SPDX-License-Identifier: Apache-2.0
#include "host/judge/baselines/pose_errors.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace mixrig::session {
namespace {

/// Three digits, as the sketch is accurate to.
double in_three_digits(double value) {
  if (!(value > 0)) return 0;
  const double scale = std::pow(10.0, 2 - std::floor(std::log10(value)));
  return std::round(value * scale) / scale;
}

double rms(double sum_of_squares, std::uint64_t count) {
  return count > 0 ? std::sqrt(sum_of_squares / static_cast<double>(count)) : 0;
}

nlohmann::json summary(const measure::QuantileSketch& sketch, double sum_of_squares) {
  return {{"rms", in_three_digits(rms(sum_of_squares, sketch.count()))},
          {"p50", in_three_digits(sketch.quantile(0.5))},
          {"p95", in_three_digits(sketch.quantile(0.95))},
          {"max", in_three_digits(sketch.max())}};
}

}  // namespace

void PoseErrors::add(const geometry::Pose& used, const geometry::Pose& truth) {
  const double shift_mm = 1e3 * (used.translation_m - truth.translation_m).norm();
  const double turn_deg = used.rotation.angularDistance(truth.rotation) * 180 / std::numbers::pi;
  if (!shift_mm_.add(shift_mm) || !turn_deg_.add(turn_deg)) return;
  shift_square_mm2_ += shift_mm * shift_mm;
  turn_square_deg2_ += turn_deg * turn_deg;
  const Eigen::AngleAxisd turn(truth.rotation * used.rotation.conjugate());
  const Off now{1e3 * (truth.translation_m - used.translation_m),
                turn.angle() * 180 / std::numbers::pi * turn.axis()};
  if (before_ && last_) {
    ++triples_;
    shift_jitter_mm2_ += (before_->shift_mm - 2 * last_->shift_mm + now.shift_mm).squaredNorm();
    turn_jitter_deg2_ += (before_->turn_deg - 2 * last_->turn_deg + now.turn_deg).squaredNorm();
  }
  before_ = last_, last_ = now;
}

nlohmann::json PoseErrors::to_json() const {
  nlohmann::json jitter;
  if (triples_ > 0)
    jitter = {{"shift_mm", in_three_digits(rms(shift_jitter_mm2_, triples_))},
              {"turn_deg", in_three_digits(rms(turn_jitter_deg2_, triples_))}};
  return {{"frames", frames()},
          {"jitter", jitter},
          {"shift_mm", summary(shift_mm_, shift_square_mm2_)},
          {"turn_deg", summary(turn_deg_, turn_square_deg2_)}};
}

std::string PoseErrors::to_line() const {
  return fmt::format(
      "{:.3g} mm, {:.3g} deg (root mean square of {} frames); p95 {:.3g} mm, {:.3g} deg",
      rms(shift_square_mm2_, frames()), rms(turn_square_deg2_, frames()), frames(),
      shift_mm_.quantile(0.95), turn_deg_.quantile(0.95));
}

}  // namespace mixrig::session
