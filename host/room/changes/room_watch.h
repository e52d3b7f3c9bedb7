// SPDX-License-Identifier: Apache-2.0
// Watches a room while it is composited: finds changes relative to its model, and tells them from
// people by how long and how still they stay.
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

/// Times for which frames must see a change before it counts, seconds.
struct WatchOptions {
  double gone_s = 8;       ///< longer than a door stays open
  double appeared_s = 12;  ///< people stand still for seconds
  double color_s = 20;     ///< people's shadows stay as long
  double lights_s = 2;
  /// A thing must move by less than this, root mean square without noise, metres, or less than 1/12
  /// of the sigma of a depth.
  double still_m = 0.001;
};

/// Options that scale all times except `lights_s` with `appeared_s`.
WatchOptions watch_options(double appeared_s);

/// Constant memory; add() allocates only for a new change. Not thread-safe.
class RoomWatch {
 public:
  /// `room_m`: box around the surfaces of the model, world.
  RoomWatch(const Eigen::AlignedBox3d& room_m, const geometry::DepthNoise& noise,
            const WatchOptions& options = {});

  /// Adds a frame, in order of time. Returns whether a new change was found.
  bool add(const WatchFrame& frame);
  /// All changes so far in the order in which they were found, also accepted ones and those that
  /// are over.
  std::vector<RoomChange> changes() const;
  /// Changes found since the last call. A moved thing is reported again when its other half is
  /// found.
  std::vector<RoomChange> news();

  /// Whether a change waits to be accepted.
  bool any_open() const;
  /// Places of the cells of changes that wait: of new surfaces, or of surfaces that are gone.
  std::vector<Eigen::Vector3d> open_places(ChangeCells::Kind kind) const;
  /// Whether such a cell lies within `reach` voxels of a place.
  bool is_open(ChangeCells::Kind kind, const Eigen::Vector3d& world_m, int reach) const;
  double voxel_m() const { return surfaces_.voxel_m(); }
  /// Share of the cells of waiting changes that the last frame saw, 0..1.
  double seen_share() const;
  /// Recent light relative to the model's.
  Eigen::Array3d light_factor() const { return lights_.state().factor; }
  /// Compares later frames with a model that contains the waiting changes.
  void accept();

 private:
  /// A change with the sums it is computed from.
  struct Found {
    RoomChange change;
    Eigen::AlignedBox3d box_m;
    double held_s = 0, against_s = 0;  ///< sums over its cells
    int cells = 0;
    int partner = 0;      ///< number of the hole that a moved thing left; 0: none
    bool hidden = false;  ///< it is the partner of another change
    bool told = false;    ///< reported by news()
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
  std::vector<std::size_t> members_;  ///< cells of the current cluster
  std::vector<std::uint8_t> visited_;
  std::vector<float> values_;
  bool started_ = false, news_ = false;
  double last_s_ = 0, last_round_s_ = 0;
  double lights_off_s_ = 0, lights_on_s_ = 0;
  int lights_change_ = 0;
  Eigen::Vector3d eye_m_{0, 0, 0};
};

}  // namespace mixrig::model
