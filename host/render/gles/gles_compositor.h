// SPDX-License-Identifier: Apache-2.0
// The compositor of the gles back end: set up in create_compositor.cpp, frames in
// compositor_gles.cpp.
#pragma once

#include <memory>
#include <optional>

#include "hal/base/parallel.h"
#include "host/render/contract/in_flight.h"
#include "host/render/frame/exposure.h"
#include "host/render/gles/compositor_gles.h"
#include "host/render/gles/frame_images.h"
#include "host/render/gles/gl/egl_context.h"
#include "host/render/gles/gl/gpu_colors.h"
#include "host/render/gles/gl/stage_timer.h"
#include "host/render/gles/passes.h"
#include "host/render/gles/plate/plate_import.h"
#include "host/render/tables/hidden_objects.h"

namespace mixrig::render::gles {

class GlesCompositor final : public Compositor {
 public:
  GlesCompositor(EglContext context, const CompositorSetup& setup);
  ~GlesCompositor() override;
  Result<void> create_passes();
  /// Keeps composites of kGpuColor in GPU memory, if the driver can copy them.
  void share_colors();
  /// Reads plates in the camera's memory, if the driver offers it.
  Result<void> import_plates(PlateImport import);
  /// Releases the context from the calling thread.
  void leave_thread() const { context_.release(); }

  Result<void> submit(const FrameInput& input, OutputMask wanted) override;
  Result<void> collect(FrameOutput& output) override;
  int in_flight() const override { return flight_.count(); }
  const CompositorState& state() const override { return state_; }

 private:
  /// A frame between submit() and collect().
  struct Frame {
    OutputMask wanted = 0;
    FrameImages images;
    Fence done;
    std::shared_ptr<const GpuPicture> gpu_color;
    /// Keeps the memory of a plate that is read in place.
    std::shared_ptr<const void> plate_memory;
    std::optional<StageTimer> timer;
  };

  const ImportedPlanes* import_plate(FrameInput& input);
  Result<void> draw(const FrameInput& input, const ImportedPlanes* planes, Frame& frame);
  ToneCurve tone_of(const FrameInput& input);
  void follow(const FrameInput& input);
  void see_through_lens();
  Result<void> upload(const FrameInput& input, bool with_plate);
  void draw_depth(bool two, StageTimer& timer);
  void key_people();
  Result<void> draw_mix(OutputMask wanted);
  /// Null if nothing is keyed.
  const KeyPass* key() const { return passes_.key ? &passes_.key->pass() : nullptr; }
  /// Null if no object takes light from other surfaces, or nothing is keyed.
  const LightPass* light_map() const { return things_ ? things_->light_map(key()) : nullptr; }

  EglContext context_;  // destroyed last
  CompositorSetup setup_;
  Tables tables_;
  FramesOfSetup frames_;
  LensFollower lens_;
  const FramePreparer* frame_ = &frames_.with_objects();  ///< preparer of this frame
  const FramePreparer* room_by_ = nullptr;                ///< preparer when the room was last drawn
  ExposureMeter meter_;
  ToneCurve tone_;
  Passes passes_;
  VirtualThings* things_ = nullptr;      ///< of this frame; null: no objects
  std::optional<PlateImports> imports_;  ///< if the driver can import
  bool has_look_ = false;                ///< the objects' look was measured, in a plate on the host
  std::optional<GpuColors> gpu_colors_;  ///< if objects are shared with a screen
  InFlight<Frame> flight_;
  CompositorState state_;
};

}  // namespace mixrig::render::gles
