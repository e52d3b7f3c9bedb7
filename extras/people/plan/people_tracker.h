// SPDX-License-Identifier: Apache-2.0
// Tracks people on the floor from frame to frame.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "extras/people/plan/body_place.h"
#include "extras/people/plan/clusters.h"

namespace mixrig::plan {

enum class Sight : std::uint8_t {
  kSeen,    ///< in this frame
  kCut,     ///< seen, but the picture's border cuts the body
  kPartly,  ///< seen, but a side of the trunk is not
  kHidden,  ///< not seen; the position is predicted by the motion
};
std::string_view name(Sight sight);

/// A person in one frame.
struct Person {
  int id = 0;                                            ///< from 1 on, never reused
  Eigen::Vector2d on_floor_m = Eigen::Vector2d::Zero();  ///< world x y
  Eigen::Vector2d velocity_m_s = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of on_floor_m
  double height_m = 0;                                   ///< largest recently seen height
  double area_m2 = 0;                                    ///< area of the surface seen in this frame
  Sight sight = Sight::kSeen;
  double since_s = 0;                     ///< first seen
  std::span<const SurfacePoint> surface;  ///< seen in this frame; valid until the next one
};

struct PeopleOptions {
  ClusterOptions clusters;
  double acceleration_m_s2 = 1.0;  ///< sigma of the change of velocity within a second
  double shape_sigma_m = 0.01;  ///< sigma of a position's error that lasts for a step of the body
  double most_hidden_s = 1.5;   ///< after this time an unseen person has left
  double left_s = 0.4;        ///< after this time an unseen person has left where nothing hides it
  int frames_to_believe = 4;  ///< frames, at most one missed in a row, that confirm a new person
};

/// Tracks by Kalman filters of constant velocity. Clusters are assigned to all filters together, by
/// Mahalanobis distance. Errors by the body's shape last longer than a frame, so their share of the
/// covariance does not fall with the number of frames (a considered bias: Schmidt 1966). One
/// thread; no allocation per frame except in the assignment.
class PeopleTracker {
 public:
  explicit PeopleTracker(const PeopleOptions& options = {});
  /// Adds a frame at `time_s`, later than the one before. Returns the confirmed people who are
  /// seen, or whom something nearer may hide.
  std::span<const Person> add(const SegmentedView& seen, double time_s);

 private:
  struct Track {
    Person person;
    Eigen::Vector4d state = Eigen::Vector4d::Zero();  ///< x y, and their speeds
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
    double last_seen_s = 0;
    std::optional<BodyWidth> width;  ///< set once both sides of the trunk were seen
    int widths = 0;                  ///< number of values in the mean width
    int hits = 0, misses = 0;
    bool is_believed = false;
    bool may_be_hidden = false;  ///< something may hide it in this frame
  };
  void predict(Track& track, double step_s) const;
  void update(Track& track, const BodyPlace& place) const;
  void see(Track& track, int cluster, const BodyPlace& at, double time_s) const;
  void begin(int cluster, double time_s, const Eigen::Vector3d& eye_m);
  void match(double time_s, const Eigen::Vector3d& eye_m);
  BodyPlace place(const Track& track, std::size_t cluster, const Eigen::Vector3d& eye_m) const;
  void drop_doubles();
  static bool may_hide(const Eigen::Vector2d& place_m, const SegmentedView& seen);
  bool has_gone(Track& track, const SegmentedView& seen, double time_s) const;

  PeopleOptions options_;
  ClusterFinder finder_;
  std::optional<double> time_s_;
  std::vector<Track> tracks_;
  std::vector<Expected> expected_;
  std::span<const Cluster> clusters_;
  std::vector<Person> people_;
  int next_id_ = 1;
};

}  // namespace mixrig::plan
