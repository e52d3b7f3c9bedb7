// SPDX-License-Identifier: Apache-2.0
// Runs the built `mixrig` as a child process and reads its output.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/without_progress.h"

namespace mixrig::test {

inline constexpr int kCommandLimit_s = 120;  // long enough for a busy machine

struct Outcome {
  int status = -1;
  std::string out, err;
  auto error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
  bool says(const std::string& what) const { return (out + err).find(what) != std::string::npos; }
};

inline Outcome run_mixrig(std::vector<std::string> arguments) {
  const TemporaryFolder folder;
  arguments.insert(arguments.begin(), MIXRIG_COMMAND);
  ChildProcess child(std::move(arguments), kCommandLimit_s, folder / "out", folder / "err");
  Outcome outcome;
  outcome.status = child.wait();
  outcome.out = read_bytes(folder / "out");
  outcome.err = without_progress(read_bytes(folder / "err"));
  return outcome;
}

/// Runs the command like run_mixrig, with stderr on a terminal.
inline Outcome run_mixrig_at_terminal(std::vector<std::string> arguments) {
  const TemporaryFolder folder;
  Outcome outcome;
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) return outcome;
  const int held = open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
  arguments.insert(arguments.begin(), MIXRIG_COMMAND);
  ChildProcess child(std::move(arguments), kCommandLimit_s, folder / "out", ptsname(terminal));
  std::thread reader([&] {
    char some[512];
    for (ssize_t n = 0; (n = read(terminal, some, sizeof some)) > 0;)
      outcome.err.append(some, static_cast<std::size_t>(n));
  });
  outcome.status = child.wait();
  close(held);  // the last writer: the reader reads the rest, then ends
  reader.join();
  close(terminal);
  outcome.out = read_bytes(folder / "out");
  return outcome;
}

/// Waits until `condition` holds; false where it does not within a minute.
inline bool wait_until(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace mixrig::test
