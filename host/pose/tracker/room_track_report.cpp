// SPDX-License-Identifier: Apache-2.0
// Reports a tracked path: errors against truth, and the path as text.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/percentile.h"
#include "host/pose/tracker/room_track.h"

namespace mixrig::session {
namespace {

/// Errors of the pictures that have a pose and truth.
struct TrackErrors {
  std::vector<double> shift_mm, turn_deg, nees, number;
  /// Lengths of the second differences of the errors from picture to picture.
  std::vector<double> shift_jitter_mm, turn_jitter_deg;
};

struct TrackError {
  Eigen::Vector3d shift_mm, turn_deg;
};

std::optional<TrackError> error_of(const TrackedPicture& p) {
  if (!p.pose.known || !p.truth) return std::nullopt;
  const Eigen::AngleAxisd turn(p.truth->rotation * p.world_from_target.rotation.conjugate());
  return TrackError{1e3 * (p.truth->translation_m - p.world_from_target.translation_m),
                    turn.angle() / kDeg * turn.axis()};
}

TrackErrors errors_of(const std::vector<TrackedPicture>& pictures) {
  TrackErrors errors;
  std::optional<TrackError> before, last;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto now = error_of(pictures[i]);
    if (now) {
      errors.shift_mm.push_back(now->shift_mm.norm());
      errors.turn_deg.push_back(now->turn_deg.norm());
      errors.number.push_back(static_cast<double>(i));
      errors.nees.push_back(pictures[i].nees);
    }
    if (now && last && before) {
      errors.shift_jitter_mm.push_back(
          (before->shift_mm - 2 * last->shift_mm + now->shift_mm).norm());
      errors.turn_jitter_deg.push_back(
          (before->turn_deg - 2 * last->turn_deg + now->turn_deg).norm());
    }
    before = last, last = now;
  }
  return errors;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double rms_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// Returns the least-squares slope of y over x; 0 for fewer than two values.
double slope_of(const std::vector<double>& x, const std::vector<double>& y) {
  const double mean_x = mean_of(x), mean_y = mean_of(y);
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
  return xx > 0 ? xy / xx : 0;
}

nlohmann::json starts_json(const RoomTrack& track, const TrackErrors& errors) {
  constexpr double kWrong_mm = 50, kWrong_deg = 1;
  std::vector<float> ms;
  for (const TrackedPicture& p : track.pictures) ms.push_back(static_cast<float>(1e3 * p.seconds));
  int wrong = 0;
  for (std::size_t i = 0; i < errors.shift_mm.size(); ++i)
    wrong += errors.shift_mm[i] > kWrong_mm || errors.turn_deg[i] > kWrong_deg ? 1 : 0;
  return {
      {"found", track.counts.pictures - track.counts.lost},
      {"wrong", errors.shift_mm.empty() ? nlohmann::json() : nlohmann::json(wrong)},
      {"refused", track.counts.lost},
      {"p50_mm", measure::quantile({errors.shift_mm.begin(), errors.shift_mm.end()}, 0.5)},
      {"search_ms", {{"p50", measure::quantile(ms, 0.5)}, {"p95", measure::quantile(ms, 0.95)}}}};
}

nlohmann::json to_json(const TrackErrors& errors) {
  return {{"rms_mm", rms_of(errors.shift_mm)},
          {"rms_deg", rms_of(errors.turn_deg)},
          {"p95_mm", measure::quantile({errors.shift_mm.begin(), errors.shift_mm.end()}, 0.95)},
          {"max_mm", *std::max_element(errors.shift_mm.begin(), errors.shift_mm.end())},
          {"drift_mm_per_1000", 1000 * slope_of(errors.number, errors.shift_mm)},
          {"jitter_mm", rms_of(errors.shift_jitter_mm)},
          {"jitter_deg", rms_of(errors.turn_jitter_deg)},
          {"nees", mean_of(errors.nees)}};
}

}  // namespace

nlohmann::json to_json(const RoomTrack& track) {
  const auto frames = static_cast<double>(track.pictures.size());
  std::vector<double> sigma_mm;
  std::vector<float> frame_ms, search_ms;
  for (const TrackedPicture& p : track.pictures) {
    const bool followed = p.pose.known && !p.pose.searched;
    (followed ? frame_ms : search_ms).push_back(static_cast<float>(1e3 * p.seconds));
    if (p.pose.known)
      sigma_mm.push_back(1e3 * std::sqrt(p.pose.covariance.diagonal().tail<3>().sum()));
  }
  nlohmann::json json = {{"frames", track.pictures.size()},
                         {"lost_pct", 100 * static_cast<double>(track.counts.lost) / frames},
                         {"fps", track.seconds > 0 ? frames / track.seconds : 0},
                         {"frame_ms", measure::quantile(frame_ms, 0.5)},
                         {"search_ms", measure::quantile(search_ms, 0.5)},
                         {"searches", track.counts.searches},
                         {"sigma_mm", mean_of(sigma_mm)},
                         {"latency_s", track.latency_s}};
  const TrackErrors errors = errors_of(track.pictures);
  if (track.anew) json["starts"] = starts_json(track, errors);
  if (errors.shift_mm.empty()) return json;
  json.update(to_json(errors));
  if (!track.unsmoothed.empty()) json["unsmoothed"] = to_json(errors_of(track.unsmoothed));
  return json;
}

std::string to_tum(const RoomTrack& track) {
  std::string text = "# t x y z qx qy qz qw of world_from_target\n";
  for (const TrackedPicture& p : track.pictures) {
    if (!p.pose.known) continue;
    const auto& t = p.world_from_target.translation_m;
    const auto& q = p.world_from_target.rotation;
    text += fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n", p.time_s,
                        t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

}  // namespace mixrig::session
