// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/heap.h"

#include <malloc.h>

namespace mixrig::bench {

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

}  // namespace mixrig::bench
