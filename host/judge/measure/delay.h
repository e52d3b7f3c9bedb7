// SPDX-License-Identifier: Apache-2.0
// Delay between a motion and its picture, by correlating the two motions. Uses no time stamp of the
// measured system (Cortes Reina 2016, section 6.3: a pendulum and its picture).
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
  double uncertainty_s = 0;  ///< standard deviation (motion); half of the fitting interval (marker)
  double correlation = 0;    ///< correlation of the two signals at that delay
};

/// Delay, 0 to `most_s`, at which `seen` (value of what is shown, at the time when it is first
/// shown) correlates best with `truth` (value of the motion at its own times, interpolated with
/// cubics). Scale and offset of the values do not matter. Only samples at least `most_s` after the
/// beginning of the truth and before its end count, so that every delay is judged by the same
/// samples. nullopt where the samples do not determine it: fewer than eight, a correlation below
/// 0.5, or a motion so even that the uncertainty exceeds a quarter of `most_s`. Preconditions: both
/// in order of time, most_s > 0.
std::optional<Delay> delay_of_motion(std::span<const Sample> truth, std::span<const Sample> seen,
                                     double most_s);

/// Delay of a blinking lamp's picture. `switches_s`: times when the lamp is switched, on first,
/// then off and on in turn. `seen`: its brightness in each picture; a picture is as bright as the
/// share of its exposure, `exposure_s` long, in which the lamp was on. The delay counts from the
/// middle of the exposure, and is the middle of the delays that explain the samples equally well.
/// nullopt where fewer than four switches or eight samples are left, or where the correlation is
/// below 0.5.
std::optional<Delay> delay_of_marker(std::span<const double> switches_s,
                                     std::span<const Sample> seen, double exposure_s,
                                     double most_s);

}  // namespace mixrig::measure
