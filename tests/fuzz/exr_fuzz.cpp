// SPDX-License-Identifier: Apache-2.0
// Any bytes as OpenEXR files: the result is channels of one size, or an error of one line.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "host/math/image_io/image_io.h"
#include "tests/fuzz/target.h"
#include "tests/support/temporary_folder.h"

MIXRIG_FUZZ_TARGET(exr) {
  using namespace mixrig;
  static const test::TemporaryFolder folder;
  const auto channels = image_io::read_exr(
      folder.write("a.exr", std::string(reinterpret_cast<const char*>(data), size)));
  if (!channels) {
    if (channels.error().context.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  for (const image_io::Channel& channel : *channels)
    if (channel.pixels.empty() || channel.pixels.size() != channels->front().pixels.size())
      std::abort();
  return 0;
}
