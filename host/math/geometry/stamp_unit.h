// SPDX-License-Identifier: Apache-2.0
// The unit of stamps that files of pictures and poses hold without saying it.
#pragma once

#include <cmath>
#include <string_view>

namespace mixrig::geometry {

struct StampUnit {
  double seconds = 1;
  std::string_view name = "seconds";
};

/// Finds the unit of a stamp by its size: 1e11 seconds after 1970 would be the year 5138, so larger
/// numbers are milliseconds or less. Smaller ones are seconds, as the formats say.
inline StampUnit unit_of_stamp(double time) {
  const double size = std::abs(time);
  if (size >= 1e17) return {1e-9, "nanoseconds"};
  if (size >= 1e14) return {1e-6, "microseconds"};
  if (size >= 1e11) return {1e-3, "milliseconds"};
  return {};
}

}  // namespace mixrig::geometry
