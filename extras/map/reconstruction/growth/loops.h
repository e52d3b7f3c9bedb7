// SPDX-License-Identifier: Apache-2.0
// Places that come into view again. Private to this module.
#pragma once

#include "extras/map/reconstruction/growth/growth.h"

namespace mixrig::reconstruction {

/// Squared distance of descriptors.
int distance_of(const Descriptor& a, const Descriptor& b);

/// A place that a key picture should show, but is not followed there, is looked for among the
/// picture's features by its descriptor, near where it should lie. A feature found gives a
/// sighting; where it belongs to another track, the two become one. Returns the number found.
int join_loops(const FeatureTracks& tracks, const geometry::AnyCamera& camera, Growth& grown);

}  // namespace mixrig::reconstruction
