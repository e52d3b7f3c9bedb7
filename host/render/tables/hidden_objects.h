// SPDX-License-Identifier: Apache-2.0
// Frames that show the virtual objects or hide them: the setup, and one without them, in camera
// axes.
#pragma once

#include <cstddef>
#include <optional>
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

/// Prepares each frame of a setup, with its objects or without them. Not thread-safe.
class FramesOfSetup {
 public:
  /// Borrows `setup`.
  explicit FramesOfSetup(const CompositorSetup& setup);
  /// The next frame's, as FramePreparer::update(); `changes` of the setup since the one before.
  /// `hides`: it shows none of the objects that may be hidden.
  const FramePreparer& update(const geometry::Pose& world_from_camera, const SetupChanges& changes,
                              bool hides);
  /// Whether the frame of the last update() is that of hidden().
  bool hides() const { return hides_; }
  const FramePreparer& with_objects() const { return preparer_; }
  /// Null where no frame hides objects.
  const HiddenObjects* hidden() const { return hidden_ ? &*hidden_ : nullptr; }

 private:
  const CompositorSetup& setup_;
  FramePreparer preparer_;
  std::optional<HiddenObjects> hidden_;
  bool hides_ = false;
};

}  // namespace mixrig::render
