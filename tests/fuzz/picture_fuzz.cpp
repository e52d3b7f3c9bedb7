// SPDX-License-Identifier: Apache-2.0
// Any bytes as PNG and JPEG pictures.
#include <cstdint>
#include <cstdlib>

#include "host/math/image_io/codecs.h"
#include "host/math/image_io/image_io.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(picture) {
  using namespace mixrig;
  Image<Rgb8> color;
  if (image_io::decode_rgb8(data, size, "x", color) && color.empty()) std::abort();
  if (!image_io::is_png({data, size})) return 0;
  Image<std::uint16_t> deep;
  if (image_io::decode_png({data, size}, "x", deep) && deep.empty()) std::abort();
  return 0;
}
