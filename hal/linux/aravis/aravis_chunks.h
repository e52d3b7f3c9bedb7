// SPDX-License-Identifier: Apache-2.0
// Chunks that a GenICam camera appends to its pictures. Private to this module.
#pragma once

#include <cstdint>

#include "hal/device/frame.h"

typedef struct _ArvBuffer ArvBuffer;            // NOLINT(modernize-use-using): as libaravis
typedef struct _ArvCamera ArvCamera;            // NOLINT(modernize-use-using)
typedef struct _ArvChunkParser ArvChunkParser;  // NOLINT(modernize-use-using)

namespace mixrig::device {

/// Largest stamp of a camera. Higher bits are cut off, since they may not fit a Duration.
inline constexpr std::uint64_t kMostAravisTime_ns = (1ULL << 62) - 1;

/// Chunks that a camera appends to each picture (SFNC 2.7, Chunk Data Control).
struct AravisChunks {
  bool timestamp = false, exposure = false, frame_id = false;
  double ns_per_tick = 1;  ///< unit of its timestamps
  bool any() const { return timestamp || exposure || frame_id; }
};
/// Enables the chunks that the camera has, and returns them. Without a timestamp chunk all chunks
/// are switched off: the picture's header then says as much.
AravisChunks choose_aravis_chunks(ArvCamera* camera);
/// Reads stamp, exposure and counter from the chunks into `frame`. The camera stamps the start of
/// the exposure (SFNC 2.7); the frame's stamp is its middle.
void read_aravis_chunks(ArvChunkParser* parser, ArvBuffer* buffer, const AravisChunks& chunks,
                        Frame& frame);

}  // namespace mixrig::device
