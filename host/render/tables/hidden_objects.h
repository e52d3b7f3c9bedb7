// SPDX-License-Identifier: Apache-2.0
// Frames that hide the virtual objects: a setup without them, in camera axes.
#pragma once

#include <cstddef>
#include <vector>

#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Whether the setup has an object that is in no set. Pure.
bool any_object_hides(const CompositorSetup& setup);

/// What of a setup stays where its objects are hidden: all but them. Its lamps, maps and the
/// set are prepared apart, so that such a frame is that of a setup without the objects. Not
/// thread-safe.
class HiddenObjects {
 public:
  /// Copies `setup`, which is complete.
  explicit HiddenObjects(const CompositorSetup& setup);
  HiddenObjects(const HiddenObjects&) = delete;
  HiddenObjects& operator=(const HiddenObjects&) = delete;

  /// Takes view, light and places of the set from `setup`, in each frame. Allocates nothing.
  void follow(const CompositorSetup& setup);
  /// Brings it to the pose of a frame that hides the objects, as FramePreparer::update().
  void update(const geometry::Pose& world_from_camera) { preparer_.update(world_from_camera); }
  const CompositorSetup& setup() const { return setup_; }
  const FramePreparer& preparer() const { return preparer_; }

 private:
  std::vector<std::size_t> kept_;  ///< which objects of the whole setup those of `setup_` are
  CompositorSetup setup_;
  FramePreparer preparer_;
};

}  // namespace mixrig::render
