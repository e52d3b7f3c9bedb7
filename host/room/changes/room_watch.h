// SPDX-License-Identifier: Apache-2.0
// Watches a room while it is composited: what is no longer as its model says, told apart from
// people by how long and how still it stays.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "host/math/geometry/depth_noise.h"
#include "host/room/changes/change_cells.h"
#include "host/room/changes/light_watch.h"
#include "host/room/changes/room_changes.h"
#include "host/room/changes/watch_frame.h"

namespace mixrig::model {

/// Times for which frames must see a change before it is one.
struct WatchOptions {
  double gone_s = 8;       ///< longer than a door stays open
  double appeared_s = 12;  ///< people stand still for seconds
  double color_s = 20;     ///< so do their shadows
  double lights_s = 2;
  /// What moves by more, root mean square without noise, or by 1/12 of the sigma of a depth, is no
  /// thing.
  double still_m = 0.001;
};

/// The same with all times but that of lights in proportion to that of what appeared.
WatchOptions watch_options(double appeared_s);

/// Constant memory; add() allocates nothing but for a change that is new. Not thread-safe.
class RoomWatch {
 public:
  /// `room_m`: around the surfaces of the model, world.
  RoomWatch(const Eigen::AlignedBox3d& room_m, const geometry::DepthNoise& noise,
            const WatchOptions& options = {});

  /// Frames in the order of their times. True where a change was found that is new.
  bool add(const WatchFrame& frame);
  /// All so far, in the order in which they were found; what was accepted and what is over too.
  std::vector<RoomChange> changes() const;
  /// Those found since the last call. What moved is told again when its other half is found.
  std::vector<RoomChange> news();

  /// Whether anything waits to be accepted.
  bool any_open() const;
  /// Of a change that waits: cells of its new surfaces, and of those that it took away.
  std::vector<Eigen::Vector3d> open_places(ChangeCells::Kind kind) const;
  /// Whether such a cell lies within `reach` voxels of a place.
  bool is_open(ChangeCells::Kind kind, const Eigen::Vector3d& world_m, int reach) const;
  double voxel_m() const { return surfaces_.voxel_m(); }
  /// Share of the open cells that the last frame saw, 0..1.
  double seen_share() const;
  /// Light of the last frames in parts of the model's.
  Eigen::Array3d light_factor() const { return lights_.state().factor; }
  /// From now on frames are held against a model that has the open changes.
  void accept();

 private:
  /// A change and what it is made of.
  struct Found {
    RoomChange change;
    Eigen::AlignedBox3d box_m;
    double held_s = 0, against_s = 0;  ///< sums over its cells
    int cells = 0;
    int partner = 0;      ///< number of the hole of a thing that moved
    bool hidden = false;  ///< it is the partner of another one
    bool told = false;
  };
  struct Cluster;

  void find_changes(double time_s);
  void cluster(ChangeCells& evidence, double least_s, ChangeKind kind, double time_s);
  void grow(ChangeCells& evidence, std::size_t seed, double least_s);
  int count_ripe(const ChangeCells& evidence, double least_s) const;
  double unrest_m(const ChangeCells& evidence);
  bool is_still(double unrest_m, const Eigen::Vector3d& center_m) const;
  void take(ChangeCells& evidence, ChangeKind kind, double time_s);
  void finish_round();
  void pair_up();
  void find_lights(double time_s, double dt_s);
  void find_colors(double time_s);
  bool is_explained(const Eigen::Vector3d& place_m) const;
  int beside(const Eigen::AlignedBox3d& box_m, ChangeKind kind) const;
  Found& add_found(ChangeKind kind, double since_s, double time_s);
  bool is_open(const ChangeCell& cell) const;
  Found& number(int n) { return found_[static_cast<std::size_t>(n - 1)]; }

  const WatchOptions options_;
  const geometry::DepthNoise noise_;
  FrameSight sight_;
  ChangeCells surfaces_, holes_;
  LightWatch lights_;
  std::vector<Found> found_;
  std::vector<std::size_t> members_;  ///< of a cluster
  std::vector<std::uint8_t> visited_;
  std::vector<float> values_;
  bool started_ = false, news_ = false;
  double last_s_ = 0, last_round_s_ = 0;
  double lights_off_s_ = 0, lights_on_s_ = 0;
  int lights_change_ = 0;
  Eigen::Vector3d eye_m_{0, 0, 0};
};

}  // namespace mixrig::model
