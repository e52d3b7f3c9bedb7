// SPDX-License-Identifier: Apache-2.0
// Tracks people on the floor from frame to frame.
#include "extras/people/plan/people_tracker.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "extras/people/plan/assignment.h"

namespace mixrig::plan {
namespace {

constexpr double kGate2 = 20;  ///< of the squared Mahalanobis distance, two values
constexpr double kGate_m = 0.7;
constexpr double kStray_m = 0.06;  ///< sigma that a position may be off in addition when matched
constexpr double kFirstSpeed_m_s = 1.0;  ///< sigma of the velocity of somebody new
constexpr double kSlowing_s = 1.0;       ///< time constant with which hidden people slow down
constexpr double kHeightFades_m_s = 0.02;
constexpr double kReachKept = 0.9;  ///< of the reach of a trunk, from frame to frame
constexpr int kMostWidths = 150, kFirstWidths = 25;  ///< in the mean; weight of the average body
constexpr double kLookedAt_m[] = {0.5, 1.0, 1.4};
constexpr double kHides_m = 0.3;
constexpr double kBody_m = 0.25;
constexpr double kWalks_m_s = 1.0, kLean_m = 0.02;  ///< walking people's trunk is so far ahead
constexpr double kLeastDeterminant_m4 = 1e-8;

}  // namespace

std::string_view name(Sight sight) {
  switch (sight) {
    case Sight::kSeen:
      return "seen";
    case Sight::kCut:
      return "cut";
    case Sight::kPartly:
      return "partly";
    case Sight::kHidden:
      return "hidden";
  }
  return "?";
}

PeopleTracker::PeopleTracker(const PeopleOptions& options)
    : options_(options), finder_(options.clusters) {}

std::span<const Person> PeopleTracker::add(const SegmentedView& seen, double time_s) {
  const double step_s = time_s_ ? std::max(1e-3, time_s - *time_s_) : 0;
  time_s_ = time_s;
  expected_.clear();
  for (Track& track : tracks_) {
    predict(track, step_s);
    if (track.is_believed) expected_.push_back({track.state.head<2>(), track.misses == 0});
  }
  clusters_ = finder_.find(seen, expected_);
  match(time_s, seen.world_from_view.translation_m);
  std::erase_if(tracks_, [&](Track& t) { return has_gone(t, seen, time_s); });
  drop_doubles();
  people_.clear();
  const double bias2 = options_.shape_sigma_m * options_.shape_sigma_m;
  for (Track& track : tracks_) {
    if (!track.is_believed || (track.misses > 0 && !track.may_be_hidden)) continue;
    const Eigen::Vector2d velocity = track.state.tail<2>();
    const double share = std::min(1.0, velocity.norm() / kWalks_m_s);
    track.person.on_floor_m = track.state.head<2>() - share * kLean_m * velocity.stableNormalized();
    track.person.velocity_m_s = track.state.tail<2>();
    track.person.covariance =
        track.covariance.topLeftCorner<2, 2>() + bias2 * Eigen::Matrix2d::Identity();
    people_.push_back(track.person);
  }
  return people_;
}

void PeopleTracker::predict(Track& track, double step_s) const {
  const double slow = track.misses > 0 ? std::exp(-step_s / kSlowing_s) : 1;
  Eigen::Matrix4d step = Eigen::Matrix4d::Identity();
  step.topRightCorner<2, 2>() = step_s * Eigen::Matrix2d::Identity();
  step.bottomRightCorner<2, 2>() *= slow;
  const double a2 = options_.acceleration_m_s2 * options_.acceleration_m_s2;
  Eigen::Matrix2d noise;  // white acceleration
  noise << step_s * step_s * step_s / 3, step_s * step_s / 2, step_s * step_s / 2, step_s;
  noise *= a2;
  track.state = step * track.state;
  track.covariance = step * track.covariance * step.transpose();
  for (int axis = 0; axis < 2; ++axis)
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) track.covariance(axis + 2 * i, axis + 2 * j) += noise(i, j);
}

void PeopleTracker::update(Track& track, const BodyPlace& place) const {
  const Eigen::Matrix2d innovation = track.covariance.topLeftCorner<2, 2>() + place.covariance;
  const Eigen::Matrix<double, 4, 2> gain = track.covariance.leftCols<2>() * innovation.inverse();
  track.state += gain * (place.on_floor_m - track.state.head<2>());
  const Eigen::Matrix4d kept = track.covariance - gain * innovation * gain.transpose();
  track.covariance = 0.5 * (kept + kept.transpose());
}

BodyPlace PeopleTracker::place(const Track& track, std::size_t cluster,
                               const Eigen::Vector3d& eye_m) const {
  return place_body(clusters_[cluster], eye_m, {track.person.height_m, track.width});
}

/// Takes a cluster over as what was seen of a person.
void PeopleTracker::see(Track& track, int cluster, const BodyPlace& at, double time_s) const {
  const Cluster& seen = clusters_[static_cast<std::size_t>(cluster)];
  Person& person = track.person;
  person.height_m =
      std::max(seen.top_m, person.height_m - kHeightFades_m_s * (time_s - track.last_seen_s));
  person.area_m2 = seen.area_m2;
  person.surface = seen.points;
  person.sight = !at.is_whole ? Sight::kPartly : seen.is_cut ? Sight::kCut : Sight::kSeen;
  if (at.is_whole) {
    const BodyWidth before = track.width.value_or(BodyWidth{kAverageBody.half_m, at.width.reach_m});
    track.widths = std::min(track.widths + 1, kMostWidths);
    track.width = {
        before.half_m + (at.width.half_m - before.half_m) / (track.widths + kFirstWidths),
        std::lerp(at.width.reach_m, before.reach_m, kReachKept)};
  }
  track.last_seen_s = time_s;
  track.misses = 0;
  if (++track.hits >= options_.frames_to_believe) track.is_believed = true;
}

void PeopleTracker::match(double time_s, const Eigen::Vector3d& eye_m) {
  const auto rows = static_cast<Eigen::Index>(tracks_.size());
  const auto columns = static_cast<Eigen::Index>(clusters_.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(rows, columns, kForbidden);
  for (Eigen::Index t = 0; t < rows; ++t)
    for (Eigen::Index c = 0; c < columns; ++c) {
      const Track& track = tracks_[static_cast<std::size_t>(t)];
      const Eigen::Vector2d at_m = track.state.head<2>();
      const auto number = static_cast<std::size_t>(c);
      if ((clusters_[number].center_m.head<2>() - at_m).norm() > kGate_m) continue;
      const BodyPlace body = place(track, number, eye_m);
      const Eigen::Vector2d off = body.on_floor_m - at_m;
      const Eigen::Matrix2d s = track.covariance.topLeftCorner<2, 2>() + body.covariance +
                                kStray_m * kStray_m * Eigen::Matrix2d::Identity();
      const double d2 = off.dot(s.inverse() * off);
      if (d2 < kGate2) cost(t, c) = d2 + std::log(s.determinant() / kLeastDeterminant_m4);
    }
  const std::vector<int> cluster_of = assign(cost);
  std::vector<bool> used(clusters_.size(), false);
  for (std::size_t t = 0; t < cluster_of.size(); ++t) {
    Track& track = tracks_[t];
    if (const int c = cluster_of[t]; c >= 0) {
      used[static_cast<std::size_t>(c)] = true;
      const BodyPlace body = place(track, static_cast<std::size_t>(c), eye_m);
      update(track, body);
      see(track, c, body, time_s);
    } else {
      ++track.misses;
      track.person.sight = Sight::kHidden, track.person.area_m2 = 0;
      track.person.surface = {};
    }
  }
  for (std::size_t c = 0; c < used.size(); ++c)
    if (!used[c] && clusters_[c].area_m2 >= options_.clusters.least_m2)
      begin(static_cast<int>(c), time_s, eye_m);
}

void PeopleTracker::begin(int cluster, double time_s, const Eigen::Vector3d& eye_m) {
  Track track;
  const BodyPlace body = place(track, static_cast<std::size_t>(cluster), eye_m);
  track.person.id = next_id_++;
  track.person.since_s = track.last_seen_s = time_s;
  track.state.head<2>() = body.on_floor_m;
  track.covariance.topLeftCorner<2, 2>() = body.covariance;
  track.covariance.bottomRightCorner<2, 2>() =
      kFirstSpeed_m_s * kFirstSpeed_m_s * Eigen::Matrix2d::Identity();
  see(track, cluster, body, time_s);
  tracks_.push_back(track);
}

/// Whether something nearer is seen where a person at this place would be. Unknown depth hides
/// nobody: a window stays unknown when everybody has gone.
bool PeopleTracker::may_hide(const Eigen::Vector2d& place_m, const SegmentedView& seen) {
  const geometry::Pose view_from_world = geometry::inverse(seen.world_from_view);
  for (const double height_m : kLookedAt_m) {
    const Eigen::Vector3d at =
        view_from_world * Eigen::Vector3d(place_m.x(), place_m.y(), height_m);
    if (at.z() <= 0) continue;
    const Eigen::Vector2d px = seen.view.project(at);
    const int x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
    const Size size = seen.visible_m.size;
    if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
    const float z = seen.visible_m.at(x, y);
    if (z > 0 && z < at.z() - kHides_m) return true;
  }
  return false;
}

/// Whether an unseen person has left: sooner where nothing hides the place.
bool PeopleTracker::has_gone(Track& track, const SegmentedView& seen, double time_s) const {
  if (track.misses == 0) return false;
  if (!track.is_believed) return track.misses > 1;
  track.may_be_hidden = may_hide(track.state.head<2>(), seen);
  return time_s - track.last_seen_s >
         (track.may_be_hidden ? options_.most_hidden_s : options_.left_s);
}

/// Two who are seen nearer to each other than bodies can be are one; the older track stays.
void PeopleTracker::drop_doubles() {
  for (std::size_t a = 0; a < tracks_.size(); ++a)
    for (std::size_t b = tracks_.size() - 1; b > a; --b)
      if (tracks_[a].misses == 0 && tracks_[b].misses == 0 &&
          (tracks_[a].state - tracks_[b].state).head<2>().norm() < kBody_m)
        tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(b));
}

}  // namespace mixrig::plan
