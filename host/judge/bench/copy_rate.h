// SPDX-License-Identifier: Apache-2.0
// How fast this machine copies memory.
#pragma once

namespace mixrig::bench {

/// Bytes a second that one thread reads and writes when it copies what no cache holds: twice the
/// copied bytes over the least of five times. Takes 0.5 GB for the moment. Measured anew in each
/// call.
double copy_bytes_per_s();

}  // namespace mixrig::bench
