// SPDX-License-Identifier: Apache-2.0
#include "host/render/backend/backend.h"

#include "hal/base/log.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/render/gles/compositor_gles.h"
#include "host/render/gles/gl/egl_context.h"

namespace mixrig::session {
namespace {

/// Whether GL runs on a GPU; opens a context for the test and closes it.
bool has_gpu() {
  if (!render::gles::may_have_gpu()) {
    log_info("app", "this machine has no GPU (no /dev/dri or the like): the cpu back end draws");
    return false;
  }
  const auto context = render::gles::EglContext::create();
  if (!context) {
    log_info("app", to_line(context.error()) + ": the cpu back end draws");
    return false;
  }
  const std::string renderer = context->renderer();
  if (!render::gles::is_software(renderer)) return true;
  log_info("app", "OpenGL ES runs in software here (" + renderer + "): the cpu back end draws");
  return false;
}

}  // namespace

bool takes_gles(BackendChoice choice) {
  return choice.backend == render::Backend::kGles ||
         (choice.backend == render::Backend::kAuto && has_gpu());
}

bool may_take_gles(BackendChoice choice) {
  return choice.backend == render::Backend::kGles ||
         (choice.backend == render::Backend::kAuto && render::gles::may_have_gpu());
}

Result<std::unique_ptr<render::Compositor>> make_compositor(const render::CompositorSetup& setup,
                                                            BackendChoice choice) {
  if (takes_gles(choice)) return render::make_gles_compositor(setup, choice.share);
  return render::make_cpu_compositor(setup, choice.threads);
}

std::string backend_of(const render::Compositor& compositor) {
  return compositor.state().renderer.starts_with("cpu") ? "cpu" : "gles";
}

}  // namespace mixrig::session
