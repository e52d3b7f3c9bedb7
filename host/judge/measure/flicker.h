// SPDX-License-Identifier: Apache-2.0
// Steadiness of the matte from frame to frame, against that of the true matte.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/image.h"
#include "host/judge/measure/errors.h"

namespace mixrig::measure {

/// Judges the pixels within kBand_px of the people's border in this frame and the one before. One
/// thread.
class MatteFlicker {
 public:
  /// A pixel is still if its true matte changes by no more than this, of 255.
  static constexpr int kStill = 2;

  /// Adds the next frame: mattes of one size, people = 255. A frame of another size begins anew.
  void add(ImageView<const std::uint8_t> matte, ImageView<const std::uint8_t> true_matte);
  /// Root mean square of the matte's change where the true matte stands still, 0..1; nullopt where
  /// no pixel could be judged.
  std::optional<double> still() const;
  /// Root mean square difference between the matte's change and the true one's, still or moving:
  /// the dtSSD of Erofeev, Gitman, Vatolin, Fedorov and Wang 2015. nullopt where no pixel could be
  /// judged.
  std::optional<double> all() const;

 private:
  Image<std::uint8_t> matte_, true_matte_, band_;  ///< images of the frame before
  Sum still_square_, square_;
};

}  // namespace mixrig::measure
