// SPDX-License-Identifier: Apache-2.0
#include "tests/board/sim_chip.h"

#include <fstream>

namespace mixrig::board {
namespace fs = std::filesystem;

SimChip::SimChip() {
  std::error_code error;
  fs::create_directories(home_ / "bank0", error);
  std::ofstream(home_ / "bank0" / "num_lines") << 8;
  std::ofstream(home_ / "live") << 1;
  std::ifstream(home_ / "bank0" / "chip_name") >> name_;
  std::string device;
  std::ifstream(home_ / "dev_name") >> device;
  lines_ = fs::path("/sys/devices/platform") / device / name_;
}

SimChip::~SimChip() {
  std::ofstream(home_ / "live") << 0;
  std::error_code error;
  fs::remove(home_ / "bank0", error);
  fs::remove(home_, error);
}

void SimChip::pull(int line, bool high) {
  std::ofstream(file(line, "pull")) << (high ? "pull-up" : "pull-down");
}

int SimChip::value(int line) const {
  int value = -1;
  std::ifstream(file(line, "value")) >> value;
  return value;
}

fs::path SimChip::file(int line, const char* what) const {
  return lines_ / ("sim_gpio" + std::to_string(line)) / what;
}

}  // namespace mixrig::board
