// SPDX-License-Identifier: Apache-2.0
// Compares two versions of a scene.
#pragma once

#include <string>

#include "host/scene/scene.h"

namespace mixrig::scene {

/// Returns the keys that a run reads only at its start and in which the scenes differ, such as
/// "camera, background"; empty: none. Objects, light and key are not among them. Pure.
std::string fixed_changes(const Scene& from, const Scene& to);

/// Whether both have equal objects in the same order, apart from their poses. Pure.
bool same_objects(const Scene& from, const Scene& to);

}  // namespace mixrig::scene
