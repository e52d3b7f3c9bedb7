// SPDX-License-Identifier: Apache-2.0
// A chip of eight simulated lines (the kernel's gpio-sim, set up through configfs).
#pragma once

#include <filesystem>
#include <string>

namespace mixrig::board {

/// One at a time. Needs root and the module gpio-sim.
class SimChip {
 public:
  SimChip();
  ~SimChip();
  SimChip(const SimChip&) = delete;
  SimChip& operator=(const SimChip&) = delete;

  /// "gpiochip2"; empty without gpio-sim.
  const std::string& name() const { return name_; }
  /// Sets the level that drives the line from outside.
  void pull(int line, bool high);
  /// Level of a line that is an output; -1 where it cannot be read.
  int value(int line) const;

 private:
  std::filesystem::path file(int line, const char* what) const;
  std::filesystem::path home_ = "/sys/kernel/config/gpio-sim/mixrig", lines_;
  std::string name_;
};

}  // namespace mixrig::board
