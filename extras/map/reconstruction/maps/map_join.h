// SPDX-License-Identifier: Apache-2.0
// Joins two maps of one take, by two cameras of one rig, in the axes of one of them (Frahm, Koeser,
// Grest and Koch 2005, section 5).
#pragma once

#include "extras/map/reconstruction/maps/learned_map.h"
#include "host/math/estimation/points/rigid_fit.h"
#include "host/pose/trajectory/align.h"

namespace mixrig::reconstruction {

struct MapJoin {
  trajectory::Alignment alignment;  ///< of the paths: a is the first map's camera, b the second's
  double scale_sigma = 0;           ///< relative, of first_from_second.scale
  estimation::Similarity first_from_second;
  double spread = 0;  ///< root mean square distance of the two paths, joined, in units of the first
};

/// Estimates the offset in time by rotation angles, rotation and scale by relative motions
/// (trajectory::align), then the axes of the second map in those of the first. Errors: kData where
/// the motion does not determine them (the error of trajectory::align), or the scale has a sigma
/// above 20 %.
Result<MapJoin> join(const LearnedMap& first, const LearnedMap& second);

/// Transforms the second map to axes, units and times of the first.
LearnedMap in_first(const LearnedMap& second, const LearnedMap& first, const MapJoin& join);

}  // namespace mixrig::reconstruction
