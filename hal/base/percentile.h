// SPDX-License-Identifier: Apache-2.0
// Percentiles and means of small samples.
#pragma once

#include <span>
#include <vector>

namespace mixrig::measure {

/// The q-quantile (q in 0..1) with linear interpolation between the two nearest ranks (Hyndman and
/// Fan 1996, type 7). 0 without samples. Samples must be finite.
double quantile(std::vector<float> samples, double q);
/// Arithmetic mean; 0 without samples.
double mean(std::span<const float> samples);

}  // namespace mixrig::measure
