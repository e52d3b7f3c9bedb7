// SPDX-License-Identifier: Apache-2.0
// Linear light of a view beyond what its plate can hold, from plates at other exposures.
#pragma once

#include <span>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// How a nominal exposure, over that of the view's frames, was found to be.
struct FoundExposure {
  double nominal = 1, measured = 1;
  int views = 0;
  std::size_t samples = 0;  ///< that measured it; 0: too few, taken from the others
  bool used = true;         ///< false: it is not what the camera says
};

/// Light over that of the plates, by nominal exposure: the median of the ratios of pixels that two
/// plates of neighbouring exposures see well, over all views; a chain from the plates on. Where too
/// few see both, the camera is taken to expose longer than it says by what the exposure before it
/// in the chain shows. A ratio further off its nominal one than a factor of 1.5 says that the
/// camera did not do what it was told: that exposure, and those that are reached by way of it, are
/// not used. The shortest last.
std::vector<FoundExposure> find_exposures(std::span<const ScanView> views);

/// Joins the plates of each view that has some at other exposures to ScanView::light, and drops
/// these. A plate counts where no channel of a pixel is saturated, by the inverse of its variance
/// (shot and read noise of a sensor of 10,000 electrons, half a step of the byte), and where it
/// agrees with the longest one that counts to four sigma and 2 %: what moved between the plates is
/// not joined. Where all are saturated, the shortest one's value is a lower limit.
void join_brackets(std::span<const FoundExposure> exposures, std::span<ScanView> views, Crew& crew);

}  // namespace mixrig::model
