// SPDX-License-Identifier: Apache-2.0
// Who takes part in a suite: a rung of the compositor, or a function of another library.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/judge/bench/input.h"
#include "host/judge/bench/suite.h"
#include "host/judge/measure/errors.h"

namespace mixrig::bench {

/// Composites frames for its time, and for its error. One thread.
class Contender {
 public:
  virtual ~Contender() = default;
  /// Makes what frame `index` of the input shows; only its own work is timed, in milliseconds.
  virtual Result<float> time(std::size_t index) = 0;
  /// The same, judged against the truth; frames in order.
  virtual Result<void> judge(std::size_t index) = 0;
  /// What is known without the times.
  virtual Row row() const = 0;
};
using ContenderPtr = std::unique_ptr<Contender>;

/// A measure of a suite, beside those of depth.
struct Measure {
  const char* key;
  std::optional<double> (*of)(const measure::Errors&);
};

/// Sets the measures of a row that have a value.
void add_errors(const measure::Errors& errors, bool depth, const std::vector<Measure>& measures,
                Row& row);

/// Times every contender on every frame in turn, `rounds` times (the order begins with another one
/// in each frame, so that a load of the machine meets all of them), after a frame that is not
/// counted; then judges them. Errors: theirs.
Result<std::vector<Row>> measure_all(const std::vector<ContenderPtr>& contenders,
                                     std::size_t frames, int rounds, const std::string& what,
                                     const ProgressFn& progress);

}  // namespace mixrig::bench
