// SPDX-License-Identifier: Apache-2.0
// What differs between two versions of a scene.
#pragma once

#include <string>

#include "host/scene/scene.h"

namespace mixrig::scene {

/// Keys that a run takes once, at its start, and in which the scenes differ: "camera, background";
/// empty: none. Objects, light and key are not among them. Pure.
std::string fixed_changes(const Scene& from, const Scene& to);

/// Whether both have the same objects in the same order, but for where they stand. Pure.
bool same_objects(const Scene& from, const Scene& to);

}  // namespace mixrig::scene
