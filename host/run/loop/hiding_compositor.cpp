// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/hiding_compositor.h"

namespace mixrig::session {

Result<void> HidingCompositor::open(const render::CompositorSetup& setup, BackendChoice backend,
                                    bool hides) {
  backend_ = backend;
  empty_setup_ = setup;
  has_objects_ =
      std::erase_if(empty_setup_.objects, [](const auto& object) { return !object.in_set; }) > 0;
  MIXRIG_ASSIGN(whole_, make_compositor(setup, backend));
  return hides && has_objects_ ? open_empty() : Result<void>();
}

Result<void> HidingCompositor::open_empty() {
  MIXRIG_ASSIGN(empty_, make_compositor(empty_setup_, backend_));
  return {};
}

void HidingCompositor::close() {
  used_ = nullptr;
  empty_.reset();
  whole_.reset();
}

Result<void> HidingCompositor::compose(const render::FrameInput& input, bool objects_shown,
                                       render::FrameOutput& output) {
  const bool hides = has_objects_ && !objects_shown;
  if (hides && !empty_) MIXRIG_TRY(open_empty());
  used_ = hides ? empty_.get() : whole_.get();
  if (!hides) return used_->compose(input, output);
  render::FrameInput without = input;
  without.world_from_object = {};
  return used_->compose(without, output);
}

}  // namespace mixrig::session
