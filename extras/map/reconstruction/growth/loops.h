// SPDX-License-Identifier: Apache-2.0
// Finds points that come into view again (loop closure). Private to this module.
#pragma once

#include "extras/map/reconstruction/growth/growth.h"

namespace mixrig::reconstruction {

/// Squared distance of two descriptors.
int distance_of(const Descriptor& a, const Descriptor& b);

/// Searches for each point that a key picture should show but that is not tracked there: among the
/// picture's features near its expected position, by descriptor. A match adds a sighting; where the
/// feature belongs to another track, the two tracks are merged. Returns the number of matches.
int join_loops(const FeatureTracks& tracks, const geometry::AnyCamera& camera, Growth& grown);

}  // namespace mixrig::reconstruction
