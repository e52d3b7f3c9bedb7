// SPDX-License-Identifier: Apache-2.0
// Per-frame parameters for frames that show the virtual objects, and for frames that hide them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// Whether the setup has an object outside the set. Pure.
bool any_object_hides(const CompositorSetup& setup);

/// A copy of a setup without the objects that may be hidden, with lamps, maps and the set prepared
/// apart: its frames are those of a setup that never had the objects. Not thread-safe.
class HiddenObjects {
 public:
  /// Copies `setup`, which must be complete.
  explicit HiddenObjects(const CompositorSetup& setup);
  HiddenObjects(const HiddenObjects&) = delete;
  HiddenObjects& operator=(const HiddenObjects&) = delete;

  /// Takes view, light and the set's poses from `setup`; called in each frame. Allocates nothing.
  void follow(const CompositorSetup& setup);
  /// Prepares a frame that hides the objects at this pose, as FramePreparer::update().
  void update(const geometry::Pose& world_from_camera) { preparer_.update(world_from_camera); }
  const CompositorSetup& setup() const { return setup_; }
  const FramePreparer& preparer() const { return preparer_; }

 private:
  std::vector<std::size_t> kept_;  ///< indices in the whole setup of the objects of `setup_`
  CompositorSetup setup_;
  FramePreparer preparer_;
};

/// Prepares each frame of a setup, with or without its objects. Not thread-safe.
class FramesOfSetup {
 public:
  /// Borrows `setup`.
  explicit FramesOfSetup(const CompositorSetup& setup);
  /// Prepares the next frame, as FramePreparer::update(). `changes`: of the setup since the frame
  /// before. `hides`: the frame shows none of the objects that may be hidden.
  const FramePreparer& update(const geometry::Pose& world_from_camera, const SetupChanges& changes,
                              bool hides);
  /// Whether the last update() prepared a frame without the objects.
  bool hides() const { return hides_; }
  const FramePreparer& with_objects() const { return preparer_; }
  /// Null if no frame may hide objects.
  const HiddenObjects* hidden() const { return hidden_ ? &*hidden_ : nullptr; }

 private:
  const CompositorSetup& setup_;
  FramePreparer preparer_;
  std::optional<HiddenObjects> hidden_;
  bool hides_ = false;
};

}  // namespace mixrig::render
