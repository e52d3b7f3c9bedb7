// SPDX-License-Identifier: Apache-2.0
// Any bytes as an image file, and as the memory layout of a USB bootloader.
#include <cstdint>
#include <string_view>
#include <vector>

#include "hal/wire/flash/dfuse.h"
#include "hal/wire/flash/firmware_image.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(firmware_image) {
  using namespace mixrig::device;
  (void)check_image({data, data + size}, "fuzz");
  (void)worth_keeping({data, size});
  (void)parse_memory_layout({reinterpret_cast<const char*>(data), size});
  return 0;
}
