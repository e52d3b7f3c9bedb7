// SPDX-License-Identifier: Apache-2.0
// Groups the pixels that the key assigned to people into clusters in space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"

namespace mixrig::plan {

/// Segmented depth of one frame: z of people, 0 elsewhere. World axes with z up and the floor at 0.
struct SegmentedView {
  ImageView<const float> depth_m;
  geometry::Pinhole view;  ///< of the size of depth_m
  geometry::Pose world_from_view;
  ImageView<const float> visible_m{};  ///< z of the visible surface; 0 unknown; may be empty
};

/// Expected position of a person, world x y.
struct Expected {
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  bool was_seen = true;  ///< in the frame before
};

/// A point of a surface that was seen, world axes.
struct SurfacePoint {
  static constexpr std::uint8_t kLeft = 1, kRight = 2;
  Eigen::Vector3f at_m;
  float area_m2 = 0;           ///< area of the pixel at its depth, facing the camera
  std::uint8_t may_go_on = 0;  ///< sides of the picture where something nearer, or its border, may
                               ///< hide more of the surface
};

struct ClusterOptions {
  double cell_m = 0.05;          ///< cell size of the plan in which points are connected
  double join_m = 0.05;          ///< gap that is bridged
  double least_m2 = 0.15;        ///< least seen surface of an unknown person
  double least_known_m2 = 0.04;  ///< least seen surface of an expected person
  double part_within_m = 0.4;    ///< smaller parts join a cluster within this distance
  double farthest_m = 12;        ///< from the camera
};

/// A person, or a group that cannot be separated. Points are valid until the next frame.
struct Cluster {
  std::span<const SurfacePoint> points;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();  ///< centre of mass of the seen surface
  double area_m2 = 0;                                  ///< of the seen surface
  double top_m = 0;                                    ///< height, without single points above
  bool is_cut = false;                                 ///< reaches the border of the picture
};

/// Finds clusters in a plan of the floor (the plan-view map of Harville 2004), so a body that the
/// picture shows in pieces stays one cluster, and people behind one another are two. Cells with
/// little surface are left out: they hold depth between a person and the room behind. No allocation
/// once the buffers have grown. One thread.
class ClusterFinder {
 public:
  explicit ClusterFinder(const ClusterOptions& options = {}) : options_(options) {}
  /// Finds clusters, the largest first. A cluster that holds several expected people, or heads with
  /// a gap between them, is divided: each cell goes to the nearest.
  std::span<const Cluster> find(const SegmentedView& seen, std::span<const Expected> expected);

 private:
  static constexpr int kNone = -1;
  static constexpr int kHeights = 128;  ///< height classes of kHeightStep_m
  struct Sample {
    SurfacePoint point;
    bool at_border = false;
    int cell = kNone;
  };
  struct Component {
    std::vector<int> cells;
    double area_m2 = 0;
    bool is_expected = false;
  };

  void collect(const SegmentedView& seen);
  void count();
  void connect();
  void fill(int first_cell, Component& component);
  void divide(std::span<const Expected> expected);
  void add_heads(const Component& component);
  double top_near_m(const Component& component, const Eigen::Vector2d& place_m) const;
  bool are_two(const Component& component, const Eigen::Vector2d& a,
               const Eigen::Vector2d& b) const;
  void divide(std::size_t component, std::span<const Eigen::Vector2d> inside_m);
  void drop_parts();
  void group();
  Component& next_component();
  Eigen::Vector2d middle_m(int cell) const;
  double distance_m(const Component& component, const Eigen::Vector2d& place_m) const;
  double distance_m(const Component& a, const Component& b) const;

  ClusterOptions options_;
  std::vector<Sample> samples_;
  std::vector<SurfacePoint> points_;  ///< by cluster
  std::vector<float> ray_x_;
  int columns_ = 0, rows_ = 0;
  Eigen::Vector2d corner_m_ = Eigen::Vector2d::Zero();
  std::vector<float> area_m2_, around_m2_;  ///< area in each cell; and with the cells around it
  std::vector<float> top_m_;                ///< of the cells
  std::vector<int> component_of_;           ///< of the cells
  std::vector<int> open_;
  std::vector<Component> components_;
  std::size_t used_ = 0;  ///< of components_
  std::vector<Eigen::Vector2d> inside_m_;
  std::vector<int> order_, begin_;
  std::vector<std::array<float, kHeights>> heights_m2_;
  std::vector<Cluster> clusters_;
};

}  // namespace mixrig::plan
