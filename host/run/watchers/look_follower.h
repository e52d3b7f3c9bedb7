// SPDX-License-Identifier: Apache-2.0
// The look of a plate as it changes while a run goes on, without steps.
#pragma once

#include <array>
#include <optional>

#include "host/render/frame/picture_look.h"

namespace mixrig::session {

/// One thread; time is that of the frames. Nothing allocates.
class LookFollower {
 public:
  static constexpr double kSettle_s = 0.12;  ///< time constant with which frames follow

  /// Of one plate. The first is in use at once; of the others the middle one of the last three
  /// counts, once it differs from what is in use by more than one plate tells.
  void add(const render::PictureLook& measured);
  /// The first one was measured in a plate that moved by so many pixels while it was exposed: its
  /// blur is less by the variance of that, in the mean of both axes. Only before another was added.
  void take_motion_out(const glm::vec2& way_px);
  bool empty() const { return count_ == 0; }
  /// Of the frame at this time. Precondition: not empty.
  const render::PictureLook& at(double time_s);
  /// What frames go to. Precondition: not empty.
  const render::PictureLook& aim() const { return aim_; }

 private:
  void go_to(const render::PictureLook& aim);

  std::array<render::PictureLook, 3> last_;
  int count_ = 0;  ///< of those that were added
  render::PictureLook aim_, from_, now_;
  float left_ = 0;  ///< share of the way from from_ to aim_
  std::optional<double> last_s_;
};

}  // namespace mixrig::session
