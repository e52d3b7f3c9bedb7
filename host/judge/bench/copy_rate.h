// SPDX-License-Identifier: Apache-2.0
// How fast this machine copies memory.
#pragma once

namespace mixrig::bench {

/// Bytes per second that one thread reads and writes when it copies memory that no cache holds:
/// twice the copied bytes over the shortest of five times. Needs 0.5 GB while it runs. Measures
/// again in each call.
double copy_bytes_per_s();

}  // namespace mixrig::bench
