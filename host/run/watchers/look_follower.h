// SPDX-License-Identifier: Apache-2.0
// The measured look of plates over a run, changed without steps.
#pragma once

#include <array>
#include <optional>

#include "host/render/frame/picture_look.h"

namespace mixrig::session {

/// For one thread; time is that of the frames. Nothing allocates.
class LookFollower {
 public:
  /// Time constant with which frames approach a new look.
  static constexpr double kSettle_s = 0.12;

  /// Adds the look of one plate. The first is used at once; later the median of the last three is
  /// used once it differs from the look in use by more than the spread of single plates.
  void add(const render::PictureLook& measured);
  /// Corrects the first look: its plate moved by `way_px` while it was exposed, so the variance of
  /// that motion, averaged over both axes, is taken from its blur. Call it before a second look is
  /// added.
  void take_motion_out(const glm::vec2& way_px);
  bool empty() const { return count_ == 0; }
  /// Look of the frame at this time. Precondition: not empty.
  const render::PictureLook& at(double time_s);
  /// The look that frames approach. Precondition: not empty.
  const render::PictureLook& aim() const { return aim_; }

 private:
  void go_to(const render::PictureLook& aim);

  std::array<render::PictureLook, 3> last_;
  int count_ = 0;  ///< number of looks added
  render::PictureLook aim_, from_, now_;
  float left_ = 0;  ///< share of the way from from_ to aim_ that is left
  std::optional<double> last_s_;
};

}  // namespace mixrig::session
