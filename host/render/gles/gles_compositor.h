// SPDX-License-Identifier: Apache-2.0
// The compositor of the back end. What is made once is in create_compositor.cpp, a frame in
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
  /// Composites of kGpuColor stay in the GPU's memory, where the driver can copy them.
  void share_colors();
  /// Plates are read in their camera's memory, where the driver offers it.
  Result<void> import_plates(PlateImport import);
  /// The context is current on no thread afterwards.
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
    std::shared_ptr<const void> plate_memory;  ///< of a plate that is read in place
    std::optional<StageTimer> timer;
  };

  const ImportedPlanes* import_plate(FrameInput& input);
  Result<void> draw(const FrameInput& input, const ImportedPlanes* planes, Frame& frame);
  ToneCurve tone_of(const FrameInput& input);
  void follow(const FrameInput& input);
  void see_through_lens();
  void upload(const FrameInput& input, bool with_plate);
  void draw_depth(bool two, StageTimer& timer);
  void key_people(const FrameInput& input);
  Result<void> draw_mix(OutputMask wanted);
  /// Null where nothing is keyed.
  const KeyPass* key() const { return passes_.key ? &passes_.key->pass() : nullptr; }
  /// Null where objects take light from nothing.
  const LightPass* light_map() const { return things_ ? things_->light_map(key()) : nullptr; }

  EglContext context_;  // dies last
  CompositorSetup setup_;
  Tables tables_;
  FramesOfSetup frames_;
  LensFollower lens_;
  const FramePreparer* frame_ = &frames_.with_objects();  ///< of this frame
  const FramePreparer* room_by_ = nullptr;                ///< that when the room was last drawn
  std::optional<Crew> crew_;                              ///< where the lens moves
  Image<glm::vec2> plate_px_;                             ///< the same
  ExposureMeter meter_;
  ToneCurve tone_;
  Passes passes_;
  VirtualThings* things_ = nullptr;      ///< of this frame
  std::optional<PlateImports> imports_;  ///< where the driver has them
  bool has_look_ = false;                ///< of virtual objects: found in a plate of the host
  std::optional<GpuColors> gpu_colors_;  ///< where objects are shared with a screen
  InFlight<Frame> flight_;
  CompositorState state_;
};

}  // namespace mixrig::render::gles
