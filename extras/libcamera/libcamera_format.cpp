// SPDX-License-Identifier: Apache-2.0
// Both lists of codes: the kernel's drm_fourcc.h and videodev2.h, and libcamera's formats.yaml for
// the codes that are its own (Bayer).
#include "extras/libcamera/libcamera_format.h"

#include <array>

namespace mixrig::device {
namespace {

struct DrmCode {
  std::uint32_t drm, v4l2;
  bool packed = false;
};

// DRM names RGB by its bits in a little-endian word: R8G8B8 is B first in memory.
constexpr std::array kDrmCodes{
    DrmCode{fourcc('Y', 'U', 'Y', 'V'), fourcc('Y', 'U', 'Y', 'V')},
    DrmCode{fourcc('N', 'V', '1', '2'), fourcc('N', 'V', '1', '2')},
    DrmCode{fourcc('M', 'J', 'P', 'G'), fourcc('M', 'J', 'P', 'G')},
    DrmCode{fourcc('B', 'G', '2', '4'), fourcc('R', 'G', 'B', '3')},
    DrmCode{fourcc('R', 'G', '2', '4'), fourcc('B', 'G', 'R', '3')},
    DrmCode{fourcc('R', '8', ' ', ' '), fourcc('G', 'R', 'E', 'Y')},
    DrmCode{fourcc('R', '1', '0', ' '), fourcc('Y', '1', '0', ' ')},
    DrmCode{fourcc('R', '1', '2', ' '), fourcc('Y', '1', '2', ' ')},
    DrmCode{fourcc('R', '1', '0', ' '), fourcc('Y', '1', '0', 'P'), true},
    DrmCode{fourcc('R', '1', '2', ' '), fourcc('Y', '1', '2', 'P'), true},
    DrmCode{fourcc('R', 'G', 'G', 'B'), fourcc('R', 'G', 'G', 'B')},
    DrmCode{fourcc('G', 'R', 'B', 'G'), fourcc('G', 'R', 'B', 'G')},
    DrmCode{fourcc('G', 'B', 'R', 'G'), fourcc('G', 'B', 'R', 'G')},
    DrmCode{fourcc('B', 'A', '8', '1'), fourcc('B', 'A', '8', '1')},
    DrmCode{fourcc('R', 'G', '1', '0'), fourcc('R', 'G', '1', '0')},
    DrmCode{fourcc('B', 'A', '1', '0'), fourcc('B', 'A', '1', '0')},
    DrmCode{fourcc('G', 'B', '1', '0'), fourcc('G', 'B', '1', '0')},
    DrmCode{fourcc('B', 'G', '1', '0'), fourcc('B', 'G', '1', '0')},
    DrmCode{fourcc('R', 'G', '1', '2'), fourcc('R', 'G', '1', '2')},
    DrmCode{fourcc('B', 'A', '1', '2'), fourcc('B', 'A', '1', '2')},
    DrmCode{fourcc('G', 'B', '1', '2'), fourcc('G', 'B', '1', '2')},
    DrmCode{fourcc('B', 'G', '1', '2'), fourcc('B', 'G', '1', '2')},
    DrmCode{fourcc('R', 'G', '1', '0'), fourcc('p', 'R', 'A', 'A'), true},
    DrmCode{fourcc('B', 'A', '1', '0'), fourcc('p', 'g', 'A', 'A'), true},
    DrmCode{fourcc('G', 'B', '1', '0'), fourcc('p', 'G', 'A', 'A'), true},
    DrmCode{fourcc('B', 'G', '1', '0'), fourcc('p', 'B', 'A', 'A'), true},
    DrmCode{fourcc('R', 'G', '1', '2'), fourcc('p', 'R', 'C', 'C'), true},
    DrmCode{fourcc('B', 'A', '1', '2'), fourcc('p', 'g', 'C', 'C'), true},
    DrmCode{fourcc('G', 'B', '1', '2'), fourcc('p', 'G', 'C', 'C'), true},
    DrmCode{fourcc('B', 'G', '1', '2'), fourcc('p', 'B', 'C', 'C'), true},
};

}  // namespace

std::uint32_t v4l2_of_drm(std::uint32_t code, std::uint64_t modifier, std::size_t planes) {
  if (modifier != 0 && modifier != kDrmCsi2Packed) return 0;
  for (const DrmCode& known : kDrmCodes) {
    if (known.drm != code || known.packed != (modifier == kDrmCsi2Packed)) continue;
    const bool two = planes == 2 && code == fourcc('N', 'V', '1', '2');
    if (planes != 1 && !two) return 0;
    return two ? fourcc('N', 'M', '1', '2') : known.v4l2;
  }
  return 0;
}

}  // namespace mixrig::device
