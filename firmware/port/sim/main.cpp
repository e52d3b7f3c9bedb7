// SPDX-License-Identifier: Apache-2.0
// The trigger controller as a Linux process, for hosts without a board.
#include <array>
#include <cstdio>
#include <cstring>

#include <time.h>

#include "firmware/port/sim/sim_board.h"
#include "firmware/port/sim/sim_line.h"

namespace {

std::uint64_t monotonic_us() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000 +
         static_cast<std::uint64_t>(now.tv_nsec) / 1000;
}

/// Serves the line until the firmware starts the bootloader, which this process does not have.
void serve(mixrig::sim::SimLine& line) {
  mixrig::sim::SimBoard board;
  const std::uint64_t start_us = monotonic_us();
  std::array<std::uint8_t, 256> buffer;
  while (!board.in_bootloader()) {
    const std::uint64_t now_us = monotonic_us() - start_us;
    board.advance_to(now_us);
    line.write(board.transmitted());
    const std::uint64_t next_us = board.next_event_us();
    const std::size_t n = line.read(buffer, next_us > now_us ? next_us - now_us : 0);
    board.advance_to(monotonic_us() - start_us);
    board.receive(std::span(buffer).first(n));
    line.write(board.transmitted());
    board.take_edges();
  }
}

}  // namespace

int main(int argc, char** argv) {
  using mixrig::sim::SimLine;
  const bool pty = argc == 3 && std::strcmp(argv[1], "--pty") == 0;
  const bool socket = argc == 3 && std::strcmp(argv[1], "--socket") == 0;
  if (!pty && !socket) {
    std::fprintf(stderr, "usage: mixrig-trigger-sim --pty LINK | --socket PATH\n");
    return 2;
  }
  std::string error;
  auto line = pty ? SimLine::open_pty(argv[2], error) : SimLine::open_socket(argv[2], error);
  if (!line) {
    std::fprintf(stderr, "error: %s\n", error.c_str());
    return 1;
  }
  serve(*line);
  return 0;
}
