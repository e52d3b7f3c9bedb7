// SPDX-License-Identifier: Apache-2.0
// The delay between a motion and its picture, from the two motions alone: no stamp of the system
// that is measured is used (Cortes Reina 2016, section 6.3: a pendulum and its picture).
#pragma once

#include <optional>
#include <span>

namespace mixrig::measure {

/// A value at a time.
struct Sample {
  double time_s = 0, value = 0;
};

struct Delay {
  double delay_s = 0;
  double uncertainty_s = 0;  ///< one sigma (motion), half of the interval that fits (marker)
  double correlation = 0;    ///< of the two signals at that delay
};

/// The delay, 0 to `most_s`, at which `seen` (value of what is shown, at the time when it is first
/// shown) correlates best with `truth` (value of the motion at its own times, interpolated with
/// cubics). Scale and offset of the values do not matter. Only samples count that lie `most_s`
/// after the beginning of the truth and before its end, so that every delay is judged by the same
/// ones. Nothing where the samples cannot tell: fewer than eight, a correlation below 0.5, or a
/// motion so even that the uncertainty exceeds a quarter of `most_s`. Preconditions: both in the
/// order of time, most_s > 0.
std::optional<Delay> delay_of_motion(std::span<const Sample> truth, std::span<const Sample> seen,
                                     double most_s);

/// The same of a lamp that blinks: `switches_s` are the times when it is switched, on first, then
/// off and on in turn; `seen` is its brightness in each picture, whose exposure lasts `exposure_s`.
/// A picture is as bright as the share of its exposure that the lamp was on. The delay is from the
/// middle of the exposure; it is the middle of those that explain the samples equally well. Nothing
/// where fewer than four switches or eight samples are left, or where the correlation is below 0.5.
std::optional<Delay> delay_of_marker(std::span<const double> switches_s,
                                     std::span<const Sample> seen, double exposure_s,
                                     double most_s);

}  // namespace mixrig::measure
