// SPDX-License-Identifier: Apache-2.0
// What each pose source of a scene needs, in one table.
#pragma once

#include "host/scene/scene.h"

namespace mixrig::scene {

/// What a pose has to do with the angles of the rig's head.
enum class HeadUse {
  kNone,
  kWatched,  ///< it does not follow the head: one that turns would make the picture wrong
  kFollowed
};
/// The world that a pose is in.
enum class PoseWorld {
  kOfFrames,  ///< that of the poses recorded with the frames
  kOfScene,   ///< that of the scene
  kOfCamera   ///< begins at the camera, or below it
};

struct PoseKind {
  PoseSource source;
  const char* name;  ///< the word of scene.toml
  HeadUse head;
  PoseWorld world;
  bool is_live;  ///< for live devices alone
};
const PoseKind& kind_of(PoseSource source);

/// Of the scene's pose source with its settings. Pure.
HeadUse head_use(const Scene& scene);

}  // namespace mixrig::scene
