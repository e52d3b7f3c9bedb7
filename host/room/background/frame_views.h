// SPDX-License-Identifier: Apache-2.0
// Depth and colour of frames in the view of a setup, and as seen from elsewhere.
#pragma once

#include <memory>

#include "hal/base/parallel.h"
#include "host/capture/capture/capture.h"
#include "host/render/backend/backend.h"
#include "host/render/cpu/background/background.h"
#include "host/room/background/learn.h"

namespace mixrig::session {

/// Warps frames into the view of `setup`, without objects, key or light. For one thread.
class FrameViews {
 public:
  /// Errors: those of make_compositor().
  static Result<FrameViews> make(const render::CompositorSetup& setup, BackendChoice backend);
  /// Colour and warped depth of a frame, valid until the next call. Errors: those of
  /// Compositor::compose().
  Result<const render::FrameOutput*> of(const capture::Capture& capture);

 private:
  std::unique_ptr<render::Compositor> compositor_;
  render::FrameOutput output_;
};

/// Draws one frame at a time as seen from elsewhere. For one thread.
class WideFrame {
 public:
  /// `crew` must outlive this object.
  WideFrame(const render::CompositorSetup& setup, const WideView& wide, Crew& crew);
  /// Draws what the camera saw at a pose into `wide`. `seen`, `depth_m`: in `view`.
  void draw(const geometry::Pinhole& view, const geometry::Pose& world_from_view,
            const Image<Rgb8>& seen, ImageView<const float> depth_m);
  const Image<float>& depth_m() const { return depth_m_; }  ///< 0 also where the colour is unknown
  const Image<Rgb8>& color() const { return color_; }

 private:
  void take_over(const render::cpu::MovingBackground& drawn);

  render::CompositorSetup setup_;
  const WideView wide_;
  Crew& crew_;
  Image<float> depth_m_;
  Image<Rgb8> color_;
};

}  // namespace mixrig::session
