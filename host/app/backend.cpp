// SPDX-License-Identifier: Apache-2.0
#include "host/app/backend.h"

#include "hal/base/log.h"
#include "host/render/cpu/compositor_cpu.h"
#ifdef MIXRIG_HAS_GLES
#include "host/render/gles/compositor_gles.h"
#include "host/render/gles/egl_context.h"
#endif

namespace mixrig::app {
namespace {

Result<std::unique_ptr<render::Compositor>> make_gles(const render::CompositorSetup& setup) {
#ifdef MIXRIG_HAS_GLES
  return render::make_gles_compositor(setup);
#else
  (void)setup;
  return Error{ErrorCode::kUnsupported,
               "the gles back end is not built in: use --backend cpu, or build with MIXRIG_GLES"};
#endif
}

/// Whether GL draws on a GPU, asked of a context that is dropped again.
bool has_gpu() {
#ifdef MIXRIG_HAS_GLES
  const auto context = render::gles::EglContext::create();
  if (!context) {
    log_info("app", to_line(context.error()) + ": cpu back end");
    return false;
  }
  const std::string renderer = context->renderer();
  if (!render::gles::is_software(renderer)) return true;
  log_info("app", "GL is software (" + renderer + "): cpu back end");
#endif
  return false;
}

}  // namespace

Result<std::unique_ptr<render::Compositor>> make_compositor(const render::CompositorSetup& setup,
                                                            BackendChoice choice) {
  const bool gles = choice.backend == render::Backend::kGles ||
                    (choice.backend == render::Backend::kAuto && has_gpu());
  if (gles) return make_gles(setup);
  return render::make_cpu_compositor(setup, choice.threads);
}

std::string backend_of(const render::Compositor& compositor) {
  return compositor.renderer().starts_with("cpu") ? "cpu" : "gles";
}

}  // namespace mixrig::app
