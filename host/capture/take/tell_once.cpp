// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/tell_once.h"

#include <mutex>
#include <set>

#include "hal/base/log.h"

namespace mixrig::take {

void tell_once(const std::string& line) {
  constexpr std::size_t kMostLines = 1000;  ///< remembered; more are those of a file gone wrong
  static std::mutex mutex;
  static std::set<std::string> told;
  {
    const std::lock_guard lock(mutex);
    if (told.size() >= kMostLines || !told.insert(line).second) return;
  }
  log_warning("take", line);
}

}  // namespace mixrig::take
