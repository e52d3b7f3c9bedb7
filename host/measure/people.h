// SPDX-License-Identifier: Apache-2.0
// Places of tracked people against the true ones.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "host/measure/quantile_sketch.h"

namespace mixrig::measure {

struct PersonThere {
  int number = 0;
  double x_m = 0, y_m = 0;  ///< on the floor, world
  double visible_m2 = 0;    ///< of the surface
};
struct PersonFound {
  int id = 0;
  double x_m = 0, y_m = 0;
  double xx_m2 = 0, yy_m2 = 0, xy_m2 = 0;  ///< covariance of the place
};

struct PeopleErrors {
  double rms_mm = 0, p95_mm = 0, max_mm = 0;  ///< of visible people
  double hidden_rms_mm = 0;                   ///< of people followed while they are hidden
  double nees = 0;                            ///< mean of e^T S^-1 e of visible people: 2 is right
  double within_95_pct = 0;                   ///< of them, in the ellipse of 95 %
  double missed_pct = 0;                      ///< of visible people, without a track
  double false_pct = 0;                       ///< of tracks, without a person
  int swaps = 0;                              ///< a person's track was another person's before
  int broken = 0;                             ///< a person has a new track
  int crossings = 0;  ///< of two people in the picture, as the camera sees them
  std::uint64_t judged = 0;
};

/// A person and a track are a pair where they are nearest to each other and within kPair_m; pairs
/// of the frame before stay while they are. One thread.
class PeopleJudge {
 public:
  static constexpr double kPair_m = 0.6;
  static constexpr double kVisible_m2 = 0.1;  ///< of a person who has to be found
  static constexpr int kGrace = 10;           ///< frames in which somebody new need not be found

  /// `eye_m`: of the camera, world x y.
  void add(std::span<const PersonThere> there, std::span<const PersonFound> found,
           const std::array<double, 2>& eye_m);
  PeopleErrors errors() const;

 private:
  struct Known {
    int id = 0;       ///< of the track; 0: none now
    int last_id = 0;  ///< of the last track
    int visible_frames = 0;
  };
  void pair(std::span<const PersonThere> there, std::span<const PersonFound> found);
  void count_change(Known& known, int number, int id);
  void count_crossings(std::span<const PersonThere> there, const std::array<double, 2>& eye_m);

  std::map<int, Known> people_;                  ///< by their number
  std::map<int, int> person_of_;                 ///< of each track, the last
  std::map<std::pair<int, int>, bool> left_of_;  ///< pairs of people
  QuantileSketch error_mm_;
  double square_mm2_ = 0, hidden_mm2_ = 0, nees_ = 0;
  std::uint64_t hidden_ = 0, within_ = 0, visible_ = 0, missed_ = 0, tracks_ = 0, false_ = 0;
  int swaps_ = 0, broken_ = 0, crossings_ = 0;
};

}  // namespace mixrig::measure
