// SPDX-License-Identifier: Apache-2.0
// Composites frames with the virtual objects, or without them while the camera's pose is lost.
#pragma once

#include <memory>

#include "hal/base/result.h"
#include "host/render/backend/backend.h"
#include "host/render/contract/compositor.h"

namespace mixrig::session {

/// Two compositors of one setup; the one without objects is made only where it is needed. Not
/// movable: the compositors point into it.
class HidingCompositor {
 public:
  HidingCompositor() = default;
  HidingCompositor(const HidingCompositor&) = delete;
  HidingCompositor& operator=(const HidingCompositor&) = delete;

  /// `setup` must outlive it. With `hides`, frames without objects are expected and prepared for;
  /// otherwise the first of them makes its compositor. Errors: those of make_compositor().
  Result<void> open(const render::CompositorSetup& setup, BackendChoice backend, bool hides);
  /// Frees the compositors.
  void close();

  /// Errors: as Compositor::compose().
  Result<void> compose(const render::FrameInput& input, bool objects_shown,
                       render::FrameOutput& output);
  /// Of the frame composited last. Precondition: there is one.
  const render::StageTimes& stage_times() const { return used_->stage_times(); }
  bool imported_plate() const { return used_->imported_plate(); }
  /// The one with objects. Precondition: open.
  const render::Compositor& whole() const { return *whole_; }

 private:
  Result<void> open_empty();

  BackendChoice backend_;
  render::CompositorSetup empty_setup_;  ///< without objects, but with the set
  bool has_objects_ = false;
  std::unique_ptr<render::Compositor> whole_, empty_;
  render::Compositor* used_ = nullptr;  ///< one of both
};

}  // namespace mixrig::session
