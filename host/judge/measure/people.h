// SPDX-License-Identifier: Apache-2.0
// Errors of tracked people's positions against the true ones.
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
  double visible_m2 = 0;    ///< visible surface
};
struct PersonFound {
  int id = 0;
  double x_m = 0, y_m = 0;
  double xx_m2 = 0, yy_m2 = 0, xy_m2 = 0;  ///< covariance of the position
};

struct PeopleErrors {
  double rms_mm = 0, p95_mm = 0, max_mm = 0;  ///< errors of visible people
  double hidden_rms_mm = 0;                   ///< error of people followed while they are hidden
  double nees = 0;                            ///< mean of e^T S^-1 e of visible people: 2 is right
  double within_95_pct = 0;  ///< share of the errors of visible people in the ellipse of 95 %
  double missed_pct = 0;     ///< share of visible people without a track
  double false_pct = 0;      ///< share of tracks without a person
  int swaps = 0;             ///< a person's track was another person's before
  int broken = 0;            ///< a person has a new track
  int crossings = 0;   ///< two people, one of them visible, swap left and right before the camera
  int occlusions = 0;  ///< a person was not visible for kShortest_s to kLongest_s
  int survived = 0;    ///< occlusions after which the person had the same track
  std::uint64_t judged = 0;
  int samples = 0;  ///< independent judged samples: one for each person in kIndependent_s
  /// Interval that holds the NEES of 95 % of such takes if the covariances are right.
  double nees_low = 0, nees_high = 0;
};

/// Judges frames in order. A person and a track are a pair where they are nearest to each other and
/// within kPair_m; pairs of the frame before stay while they are within it. One thread.
class PeopleJudge {
 public:
  static constexpr double kPair_m = 0.6;
  static constexpr double kVisible_m2 = 0.1;  ///< from here on a person must be found
  static constexpr int kGrace = 10;           ///< frames in which a new person need not be found
  static constexpr double kShortest_s = 0.3, kLongest_s = 1.5;  ///< duration of an occlusion
  static constexpr double kIndependent_s = 0.5;  ///< between samples: a body's errors last as long

  /// `eye_m`: x and y of the camera in the world. `time_s`: time of the frame, after the one
  /// before.
  void add(std::span<const PersonThere> there, std::span<const PersonFound> found,
           const std::array<double, 2>& eye_m, double time_s);
  PeopleErrors errors() const;

 private:
  struct Known {
    int id = 0;       ///< current track; 0: none
    int last_id = 0;  ///< last track
    int visible_frames = 0;
    int seen_id = 0;                  ///< track when the person was last visible; 0: none
    double seen_s = 0;                ///< time when the person was last visible
    int id_before = 0;                ///< track before the last occlusion, until that is judged
    std::optional<double> sampled_s;  ///< time of the last independent sample
  };
  void pair(std::span<const PersonThere> there, std::span<const PersonFound> found);
  void count_change(Known& known, int number, int id);
  void count_occlusion(Known& known, double time_s);
  void count_crossings(std::span<const PersonThere> there, const std::array<double, 2>& eye_m);

  std::map<int, Known> people_;                  ///< by their number
  std::map<int, int> person_of_;                 ///< last person of each track
  std::map<std::pair<int, int>, bool> left_of_;  ///< for pairs of people
  QuantileSketch error_mm_;
  double square_mm2_ = 0, hidden_mm2_ = 0, nees_ = 0;
  std::uint64_t hidden_ = 0, within_ = 0, visible_ = 0, missed_ = 0, tracks_ = 0, false_ = 0;
  int swaps_ = 0, broken_ = 0, crossings_ = 0, occlusions_ = 0, survived_ = 0, samples_ = 0;
};

}  // namespace mixrig::measure
