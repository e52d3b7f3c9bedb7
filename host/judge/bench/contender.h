// SPDX-License-Identifier: Apache-2.0
// Participant of a suite: a quality level of the compositor, or a function of another library.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/judge/bench/input.h"
#include "host/judge/bench/suite.h"
#include "host/judge/measure/errors.h"

namespace mixrig::bench {

/// Composites frames to measure time, and again to measure error. One thread.
class Contender {
 public:
  virtual ~Contender() = default;
  /// Makes what frame `index` of the input shows. Returns milliseconds of its own work alone.
  virtual Result<float> time(std::size_t index) = 0;
  /// Makes frame `index` and judges it against the truth; called for frames in order.
  virtual Result<void> judge(std::size_t index) = 0;
  /// Row of results, without the times.
  virtual Row row() const = 0;
};
using ContenderPtr = std::unique_ptr<Contender>;

/// A further measure of a suite, besides those of depth.
struct Measure {
  const char* key;
  std::optional<double> (*of)(const measure::Errors&);
};

/// Sets the measures of a row that have a value.
void add_errors(const measure::Errors& errors, bool depth, const std::vector<Measure>& measures,
                Row& row);

/// Times every contender on every frame, `rounds` times, after one frame that is not counted; then
/// judges them. Each frame starts with another contender, so that load of the machine affects all.
/// Errors: those of the contenders.
Result<std::vector<Row>> measure_all(const std::vector<ContenderPtr>& contenders,
                                     std::size_t frames, int rounds, const std::string& what,
                                     const ProgressFn& progress);

}  // namespace mixrig::bench
