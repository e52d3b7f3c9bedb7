// SPDX-License-Identifier: Apache-2.0
// Memory that this process has allocated.
#pragma once

namespace mixrig::bench {

/// Bytes in use in malloc's heap and in its mapped blocks, by mallinfo2().
double heap_bytes();

}  // namespace mixrig::bench
