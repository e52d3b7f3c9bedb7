// SPDX-License-Identifier: Apache-2.0
// Chooses the back end that composites.
#pragma once

#include <memory>

#include "hal/base/result.h"
#include "host/render/contract/compositor.h"

namespace mixrig::session {

struct BackendChoice {
  render::Backend backend = render::Backend::kAuto;
  int threads = 0;          ///< of the cpu back end; 0 = one per core
  render::GlShare share{};  ///< of the gles back end: with a screen that shows its composites
};

/// Whether make_compositor() takes the gles back end. Opens a context for the test and closes it.
bool takes_gles(BackendChoice choice);

/// Whether it may; opens nothing.
bool may_take_gles(BackendChoice choice);

/// A compositor for `setup`, which must outlive it. kAuto uses gles on a real GPU, and cpu where
/// there is none, where GL is software, or where gles is not built in.
/// Errors: kUnsupported for gles where it is not built in; those of the back end.
Result<std::unique_ptr<render::Compositor>> make_compositor(const render::CompositorSetup& setup,
                                                            BackendChoice choice);
/// "gles" or "cpu": the back end of the compositor, by its renderer string.
std::string backend_of(const render::Compositor& compositor);

}  // namespace mixrig::session
