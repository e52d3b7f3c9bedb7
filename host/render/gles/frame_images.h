// SPDX-License-Identifier: Apache-2.0
// Copies the images of one frame from the passes to the host.
#pragma once

#include "host/render/gles/gl/read_back.h"
#include "host/render/gles/passes.h"

namespace mixrig::render::gles {

/// Images of one frame in flight.
class FrameImages {
 public:
  /// Queues copies of the wanted images. `light`: null if no object takes light from other
  /// surfaces.
  void start(OutputMask wanted, const Passes& passes, const LightPass* light);
  /// Waits for the copies and stores them in `output`, whose wanted images have the view's size.
  /// Images that the scene does not produce are filled with constants. Errors: those of ReadBack.
  Result<void> fetch(FrameOutput& output) const;

 private:
  Result<void> fetch_warped_depth(Image<float>& depth_m) const;

  OutputMask wanted_ = 0, read_ = 0;  ///< `read_`: images that the buffers below hold
  ReadBack color_and_matte_, mixed_, segmented_, warped_w_, state_, light_, layer_, alpha_;
};

}  // namespace mixrig::render::gles
