// SPDX-License-Identifier: Apache-2.0
// Waits for other threads, independently of their speed.
#pragma once

#include <chrono>
#include <thread>

namespace mixrig::test {

/// True as soon as `condition` holds; false after two minutes, a limit for tests that would hang.
template <typename Condition>
bool comes_true(Condition condition) {
  constexpr int kShortWaits = 50;  // most conditions come true within those
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  for (int tries = 0; !condition(); ++tries) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(tries < kShortWaits ? 20 : 1000));
  }
  return true;
}

}  // namespace mixrig::test
