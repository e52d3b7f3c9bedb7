// SPDX-License-Identifier: Apache-2.0
// Which lamps of a room have changed since it was learned, told apart from the camera's exposure.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::lights {

/// A place of the learned room and what it shows now.
struct WatchedPlace {
  /// Of its light when it was learned, by source: ambient first, then each lamp; the sum is 1.
  Eigen::VectorXd share;
  double ratio = 0;  ///< linear plate now over learned colour
  int surface = 0;   ///< places of one number lie together, on one side of things
};

/// Of each source, ambient first.
struct LightChange {
  /// Light now over light then, times the camera's gain: what a place shows is sum(share * shown).
  Eigen::VectorXd shown;
  Eigen::VectorXd sigma;  ///< of `shown`, by the scatter of the places
  /// Share of its light, 0..1, that falls on surfaces which its own change explains better than the
  /// gain alone; and how many these are.
  Eigen::VectorXd agreed;
  Eigen::VectorXi surfaces;
  Eigen::VectorXd part;      ///< of the light at the places when they were learned; the sum is 1
  double gain = 1;           ///< the camera's: what most of the light agrees on, by its share
  double gain_weight = 0;    ///< share of the light that agrees on it, 0..1
  double places_weight = 0;  ///< share of the places that the sources explain, 0..1
};

/// Least squares with Tukey's weights, no source below zero: people and things that moved are
/// outliers while they fill less than half of the places. A source that the places do not tell from
/// others stays near the median ratio. Nullopt with fewer than 100 places. Pure; every share must
/// have as many sources.
std::optional<LightChange> fit_light_change(std::span<const WatchedPlace> places);

}  // namespace mixrig::lights
