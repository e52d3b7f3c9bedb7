// SPDX-License-Identifier: Apache-2.0
// Tracks are aligned to their mean look.
#include "extras/map/reconstruction/features/track_align.h"
#include "extras/map/reconstruction/growth/surveyor.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

}  // namespace

/// Pixels at `to` per pixel at `from`, on a plane across the view through the place; where that is
/// not known, far away.
std::optional<Eigen::Matrix2d> Surveyor::turned(const Sighting& from, const Sighting& to,
                                                const std::optional<Vector3d>& place) const {
  constexpr double kFar = 1e6;
  const auto middle = geometry::unproject(camera_, from.px);
  if (!middle) return std::nullopt;
  const double depth = place ? (pose(from) * *place).norm() : kFar;
  const Pose to_from = pose(to) * geometry::inverse(pose(from));
  const auto seen = [&](double u, double v) -> std::optional<Eigen::Vector2d> {
    const auto ray = geometry::unproject(camera_, from.px + Eigen::Vector2d(u, v));
    if (!ray) return std::nullopt;
    return geometry::project(camera_, to_from * Vector3d(depth / ray->dot(*middle) * *ray));
  };
  const auto left = seen(-2, 0), right = seen(2, 0), up = seen(0, -2), down = seen(0, 2);
  if (!left || !right || !up || !down) return std::nullopt;
  Eigen::Matrix2d out;
  out << (*right - *left) / 4, (*down - *up) / 4;
  return out;
}

void Surveyor::align_track(FeatureTrack& track, const std::optional<Vector3d>& place) const {
  std::vector<Sighting> there;
  for (const Sighting& s : track.seen)
    if (result_.poses[number(s)]) there.push_back(s);
  if (there.size() < 2) return;
  const std::size_t reference = there.size() / 2;
  std::vector<TrackLook> looks;
  std::vector<std::size_t> of_look;
  std::size_t middle = 0;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const Image<std::uint8_t>& grey = tracks_.greys[number(there[i])];
    const auto turn = turned(there[reference], there[i], place);
    if (grey.size() != geometry::size_px(camera_) || !turn) continue;
    if (i == reference) middle = looks.size() + 1;
    looks.push_back({&grey, there[i].px, *turn, 0}), of_look.push_back(i);
  }
  if (middle == 0 || !align_looks(looks, middle - 1)) return;
  track.seen.clear();
  for (std::size_t k = 0; k < looks.size(); ++k)
    if (looks[k].sigma_px > 0)
      track.seen.push_back({there[of_look[k]].picture, looks[k].px, looks[k].sigma_px});
}

void Surveyor::align(Crew& crew) {
  if (tracks_.greys.size() != result_.poses.size()) return;
  crew.rows(static_cast<int>(result_.tracks.size()), 16, [&](int begin, int end) {
    for (int t = begin; t < end; ++t) {
      const auto i = static_cast<std::size_t>(t);
      align_track(result_.tracks[i], result_.places[i]);
    }
  });
}

}  // namespace mixrig::reconstruction
