// SPDX-License-Identifier: Apache-2.0
// Finds which lamps of a room have changed since it was learned, apart from the camera's exposure.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::lights {

/// A place of the learned room and its present brightness.
struct WatchedPlace {
  /// Shares of its learned light by source, ambient first, then each lamp; the sum is 1.
  Eigen::VectorXd share;
  double ratio = 0;  ///< linear plate now over learned colour
  int surface = 0;   ///< places with the same number lie together, on one side of things
};

/// Changes of all sources; each vector has one entry a source, ambient first.
struct LightChange {
  /// Light now over light then, times the camera's gain: a place's ratio is sum(share * shown).
  Eigen::VectorXd shown;
  Eigen::VectorXd sigma;  ///< of `shown`, from the scatter of the places
  /// Share of the source's light, 0..1, that falls on surfaces which its own change explains better
  /// than the gain alone; and the number of these surfaces.
  Eigen::VectorXd agreed;
  Eigen::VectorXi surfaces;
  Eigen::VectorXd part;  ///< share of all light at the places when they were learned; the sum is 1
  double gain = 1;       ///< the camera's gain, on which most of the light agrees
  double gain_weight = 0;    ///< share of the light that agrees on the gain, 0..1
  double places_weight = 0;  ///< share of the places that the sources explain, 0..1
};

/// Fits the changes by least squares with Tukey's weights, no source below zero: people and moved
/// things are outliers while they cover less than half of the places. A source that the places do
/// not distinguish stays near the median ratio. Nullopt with less than 100 places. Pure.
/// Precondition: every `share` has the same length.
std::optional<LightChange> fit_light_change(std::span<const WatchedPlace> places);

}  // namespace mixrig::lights
