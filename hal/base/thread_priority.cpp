// SPDX-License-Identifier: Apache-2.0
#include "hal/base/thread_priority.h"

#include <sys/resource.h>
#include <unistd.h>

namespace mixrig {

void lower_thread_priority() {
  constexpr int kNice = 10;
  // On Linux a nice value belongs to a thread, and 0 stands for the calling one.
  (void)::setpriority(PRIO_PROCESS, 0, kNice);
}

}  // namespace mixrig
