// SPDX-License-Identifier: Apache-2.0
// Table of what each pose source of a scene needs.
#pragma once

#include "host/scene/scene.h"

namespace mixrig::scene {

/// How a pose depends on the angles of the rig's head.
enum class HeadUse {
  kNone,
  kWatched,  ///< the pose does not follow the head: a turning head would make the picture wrong
  kFollowed
};
/// World frame of a pose.
enum class PoseWorld {
  kOfFrames,  ///< the world of the poses recorded with the frames
  kOfScene,   ///< the world of the scene
  kOfCamera   ///< origin at the camera, or on the floor below it
};

struct PoseKind {
  PoseSource source;
  const char* name;  ///< the word of scene.toml
  HeadUse head;
  PoseWorld world;
  bool is_live;  ///< only for live devices
};
const PoseKind& kind_of(PoseSource source);

/// Returns the head use of the scene's pose source and its settings. Pure.
HeadUse head_use(const Scene& scene);

}  // namespace mixrig::scene
