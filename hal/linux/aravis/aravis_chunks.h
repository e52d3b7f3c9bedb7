// SPDX-License-Identifier: Apache-2.0
// Chunks that a GenICam camera appends to its pictures. Private to this module.
#pragma once

#include <cstdint>

#include "hal/device/frame.h"

typedef struct _ArvBuffer ArvBuffer;            // NOLINT(modernize-use-using): as libaravis
typedef struct _ArvCamera ArvCamera;            // NOLINT(modernize-use-using)
typedef struct _ArvChunkParser ArvChunkParser;  // NOLINT(modernize-use-using)

namespace mixrig::device {

/// A camera's stamp may not fit a Duration: its higher bits are left out.
inline constexpr std::uint64_t kMostAravisTime_ns = (1ULL << 62) - 1;

/// What a camera appends to each picture (SFNC 2.7, Chunk Data Control).
struct AravisChunks {
  bool timestamp = false, exposure = false, frame_id = false;
  double ns_per_tick = 1;  ///< of its timestamps
  bool any() const { return timestamp || exposure || frame_id; }
};
/// Switches those chunks on that the camera has, the others as they are; off where it has no
/// timestamp, as the picture's header then tells as much.
AravisChunks choose_aravis_chunks(ArvCamera* camera);
/// Stamp, exposure and counter as the camera appended them. Its stamp is that of the start of the
/// exposure (SFNC 2.7), the frame's is of its middle.
void read_aravis_chunks(ArvChunkParser* parser, ArvBuffer* buffer, const AravisChunks& chunks,
                        Frame& frame);

}  // namespace mixrig::device
