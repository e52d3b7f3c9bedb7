// SPDX-License-Identifier: Apache-2.0
// What a compositor sets up once: context, passes, and optional features of the driver.
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/render/gles/gles_compositor.h"

namespace mixrig::render {
namespace gles {

GlesCompositor::GlesCompositor(EglContext context, const CompositorSetup& setup)
    : context_(std::move(context)),
      setup_(setup),
      tables_(make_tables(setup_)),
      frames_(setup_),
      lens_(setup_),
      meter_(tables_, setup_.background) {
  state_.renderer = context_.renderer();
  for (Frame& frame : flight_.slots()) frame.timer.emplace(context_);
}

// GL names must be deleted in the context that made them.
GlesCompositor::~GlesCompositor() {
  (void)context_.make_current();
  if (flight_.count() > 0) glFinish();  // buffers of cameras are given back now
}

Result<void> GlesCompositor::create_passes() {
  MIXRIG_ASSIGN(passes_, Passes::create(setup_, tables_, meter_.places(),
                                        frames_.with_objects().params(), frames_.hidden()));
  if (glGetError() == GL_NO_ERROR) return {};
  return Error{ErrorCode::kUnsupported,
               "the OpenGL ES driver (" + state_.renderer +
                   ") lacks memory or a format for this view: use --backend cpu"};
}

void GlesCompositor::share_colors() {
  if (GpuColors::are_possible())
    gpu_colors_.emplace(tables_.view_size);
  else
    log_info("render",
             state_.renderer + " does not copy between textures: composites are read back");
}

Result<void> GlesCompositor::import_plates(PlateImport import) {
  if (import == PlateImport::kOnGpu && is_software(state_.renderer)) {
    state_.why_copied = state_.renderer + " draws on the processor";
    return {};
  }
  const auto calls = find_import_calls(context_);
  if (!calls) {
    state_.why_copied = calls.error().context;
    return {};
  }
  imports_.emplace(*calls);
  state_.plate_need = PlateNeed::kShared;
  state_.why_copied.clear();
  return passes_.plate.prepare_decoding();
}

}  // namespace gles

Result<std::unique_ptr<Compositor>> make_gles_compositor(const CompositorSetup& setup,
                                                         const GlShare& share, PlateImport import) {
  MIXRIG_TRY(validate(setup));
  MIXRIG_ASSIGN(gles::EglContext context, share.display != nullptr
                                              ? gles::EglContext::create_sharing(share)
                                              : gles::EglContext::create());
  auto compositor = std::make_unique<gles::GlesCompositor>(std::move(context), setup);
  const SystemClock clock;
  const HostTime begin = clock.now();
  MIXRIG_TRY(compositor->create_passes());
  log_info("render", fmt::format("{}: shaders are ready after {:.0f} ms",
                                 compositor->state().renderer, milliseconds(clock.now() - begin)));
  if (share.display != nullptr) compositor->share_colors();
  MIXRIG_TRY(compositor->import_plates(import));
  compositor->leave_thread();
  return std::unique_ptr<Compositor>(std::move(compositor));
}

}  // namespace mixrig::render
