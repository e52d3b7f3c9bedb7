// SPDX-License-Identifier: Apache-2.0
// Linear light of a view beyond the range of its plate, from plates at other exposures.
#pragma once

#include <span>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// A nominal exposure, relative to that of the view's frames, and its measured value.
struct FoundExposure {
  double nominal = 1, measured = 1;
  int views = 0;
  std::size_t samples = 0;  ///< pixels that measured it; 0: too few, taken from the other exposures
  bool used = true;         ///< false: the camera did not set it, or one before it in the chain
};

/// Measures the light of each nominal exposure relative to the plates': the median ratio of pixels
/// that two plates of neighbouring exposures see well, over all views, without those that
/// contradict it, multiplied along the chain from the plates on. Where too few pixels are seen by
/// both, the deviation of the exposure before it in the chain is assumed. An exposure whose ratio
/// differs from its nominal one by more than a factor of 1.5 was not set by the camera: it and the
/// exposures after it in the chain are not used. The shortest exposure comes last.
std::vector<FoundExposure> find_exposures(std::span<const ScanView> views);

/// Joins the plates at other exposures of each view to ScanView::light, and drops these plates. A
/// plate counts where no channel of a pixel is saturated, weighted by the inverse of its variance
/// (shot and read noise of a sensor of 10,000 electrons, half a step of the byte), and where it
/// agrees with the longest one that counts to four sigma and 2 %, so that motion between the plates
/// is not joined. Where all are saturated, the value of the shortest one is a lower limit.
void join_brackets(std::span<const FoundExposure> exposures, std::span<ScanView> views, Crew& crew);

}  // namespace mixrig::model
