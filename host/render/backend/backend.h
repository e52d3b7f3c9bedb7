// SPDX-License-Identifier: Apache-2.0
// Chooses the back end that composites.
#pragma once

#include <memory>

#include "hal/base/result.h"
#include "host/render/contract/compositor.h"

namespace mixrig::session {

struct BackendChoice {
  render::Backend backend = render::Backend::kAuto;
  int threads = 0;  ///< of the cpu back end; 0: one a core
  render::GlShare
      share{};  ///< for the gles back end: context of the screen that shows its composites
};

/// Whether make_compositor() would take the gles back end. Opens a GL context for the test and
/// closes it.
bool takes_gles(BackendChoice choice);

/// Whether make_compositor() could take the gles back end: forced, or a GPU may be there. Opens
/// nothing.
bool may_take_gles(BackendChoice choice);

/// Makes a compositor for `setup`, which must outlive it. kAuto takes gles on a real GPU, and cpu
/// where there is none, where GL is software, or where gles is not built in. Errors: kUnsupported
/// for gles where it is not built in; those of the back end.
Result<std::unique_ptr<render::Compositor>> make_compositor(const render::CompositorSetup& setup,
                                                            BackendChoice choice);
/// Returns "gles" or "cpu" for the compositor, by its renderer string.
std::string backend_of(const render::Compositor& compositor);

}  // namespace mixrig::session
