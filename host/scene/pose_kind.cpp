// SPDX-License-Identifier: Apache-2.0
#include "host/scene/pose_kind.h"

#include <array>

namespace mixrig::scene {
namespace {

constexpr std::array<PoseKind, 10> kPoseKinds{{
    {PoseSource::kTake, "take", HeadUse::kWatched, PoseWorld::kOfFrames, false},
    {PoseSource::kFloor, "floor", HeadUse::kWatched, PoseWorld::kOfCamera, false},
    {PoseSource::kIdentity, "identity", HeadUse::kWatched, PoseWorld::kOfCamera, false},
    {PoseSource::kFixed, "fixed", HeadUse::kWatched, PoseWorld::kOfScene, false},
    {PoseSource::kRecorded, "recorded", HeadUse::kNone, PoseWorld::kOfFrames, false},
    {PoseSource::kPanTilt, "pan_tilt", HeadUse::kFollowed, PoseWorld::kOfScene, false},
    {PoseSource::kMocap, "mocap", HeadUse::kNone, PoseWorld::kOfScene, true},
    {PoseSource::kTracker, "tracker", HeadUse::kFollowed, PoseWorld::kOfScene, false},
    {PoseSource::kFreeD, "freed", HeadUse::kNone, PoseWorld::kOfScene, true},
    {PoseSource::kOpenTrack, "opentrackio", HeadUse::kNone, PoseWorld::kOfScene, true},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kPoseKinds.size(); ++i)
    if (static_cast<std::size_t>(kPoseKinds[i].source) != i) return false;
  return true;
}
static_assert(in_order());

}  // namespace

const PoseKind& kind_of(PoseSource source) { return kPoseKinds[static_cast<std::size_t>(source)]; }

const char* name(PoseSource source) { return kind_of(source).name; }

HeadUse head_use(const Scene& scene) {
  // A tracker that predicts by the camera's own velocity needs no angles.
  if (scene.pose_source == PoseSource::kTracker && scene.camera.predict == Predict::kVelocity)
    return HeadUse::kNone;
  return kind_of(scene.pose_source).head;
}

}  // namespace mixrig::scene
