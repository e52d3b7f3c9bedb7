// SPDX-License-Identifier: Apache-2.0
// What this process has allocated.
#pragma once

namespace mixrig::bench {

/// Bytes in use of malloc's heap and of its mapped blocks, by mallinfo2().
double heap_bytes();

}  // namespace mixrig::bench
