// SPDX-License-Identifier: Apache-2.0
// The images of one frame on their way from the passes to the host.
#pragma once

#include "host/render/gles/gl/read_back.h"
#include "host/render/gles/passes.h"

namespace mixrig::render::gles {

/// Memory of one frame in flight.
class FrameImages {
 public:
  /// Queues the copies of the wanted images. `light`: null where objects take light from nothing.
  void start(OutputMask wanted, const Passes& passes, const LightPass* light);
  /// Waits for the copies and stores them in `output`, whose wanted images have the view's size.
  /// What the scene does not have is filled in. Errors: those of ReadBack.
  Result<void> fetch(FrameOutput& output) const;

 private:
  Result<void> fetch_warped_depth(Image<float>& depth_m) const;

  OutputMask wanted_ = 0, read_ = 0;  ///< `read_`: what the buffers below hold
  ReadBack color_and_matte_, mixed_, segmented_, warped_w_, state_, light_, layer_, alpha_;
};

}  // namespace mixrig::render::gles
