// SPDX-License-Identifier: Apache-2.0
// Places of tracked people against the true ones.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "hal/base/quantile_sketch.h"

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
  int crossings = 0;   ///< of two people in the picture, as the camera sees them
  int occlusions = 0;  ///< people who were not visible for kShortest_s to kLongest_s
  int survived = 0;    ///< of them, who then had the track of before
  std::uint64_t judged = 0;
  int samples = 0;  ///< independent ones among those judged: one a person in kIndependent_s
  /// In which the NEES of 95 % of such takes lies, where the covariances are right.
  double nees_low = 0, nees_high = 0;
};

/// A person and a track are a pair where they are nearest to each other and within kPair_m; pairs
/// of the frame before stay while they are. One thread.
class PeopleJudge {
 public:
  static constexpr double kPair_m = 0.6;
  static constexpr double kVisible_m2 = 0.1;  ///< of a person who has to be found
  static constexpr int kGrace = 10;           ///< frames in which somebody new need not be found
  static constexpr double kShortest_s = 0.3, kLongest_s = 1.5;  ///< of an occlusion
  static constexpr double kIndependent_s = 0.5;  ///< a step: errors of a body last as long

  /// `eye_m`: of the camera, world x y. `time_s`: of the frame, later than the one before.
  void add(std::span<const PersonThere> there, std::span<const PersonFound> found,
           const std::array<double, 2>& eye_m, double time_s);
  PeopleErrors errors() const;

 private:
  struct Known {
    int id = 0;       ///< of the track; 0: none now
    int last_id = 0;  ///< of the last track
    int visible_frames = 0;
    int seen_id = 0;    ///< of the track when the person was last visible; 0: none
    double seen_s = 0;  ///< when that was
    int id_before = 0;  ///< of the track before the last occlusion, until it is judged
    std::optional<double> sampled_s;  ///< the last independent sample
  };
  void pair(std::span<const PersonThere> there, std::span<const PersonFound> found);
  void count_change(Known& known, int number, int id);
  void count_occlusion(Known& known, double time_s);
  void count_crossings(std::span<const PersonThere> there, const std::array<double, 2>& eye_m);

  std::map<int, Known> people_;                  ///< by their number
  std::map<int, int> person_of_;                 ///< of each track, the last
  std::map<std::pair<int, int>, bool> left_of_;  ///< pairs of people
  QuantileSketch error_mm_;
  double square_mm2_ = 0, hidden_mm2_ = 0, nees_ = 0;
  std::uint64_t hidden_ = 0, within_ = 0, visible_ = 0, missed_ = 0, tracks_ = 0, false_ = 0;
  int swaps_ = 0, broken_ = 0, crossings_ = 0, occlusions_ = 0, survived_ = 0, samples_ = 0;
};

}  // namespace mixrig::measure
