// SPDX-License-Identifier: Apache-2.0
// Priority of the calling thread.
#pragma once

namespace mixrig {

/// Lets other threads of the process go first (nice 10): for work that must not delay the
/// compositor. Has no effect where the system refuses.
void lower_thread_priority();

}  // namespace mixrig
