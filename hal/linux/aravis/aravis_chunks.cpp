// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/aravis/aravis_chunks.h"

#include <arv.h>

#include "hal/linux/aravis/aravis_setup.h"

namespace mixrig::device {
namespace {

constexpr double kMostExposure_us = 1e8;

bool has_feature(ArvDevice* device, const char* name) {
  AravisFault fault;
  return arv_device_is_feature_available(device, name, fault) && !fault.any();
}

/// Enables a chunk; false if the camera does not have it, or does not let it be switched.
bool enable_chunk(ArvDevice* device, const char* chunk) {
  AravisFault fault;
  arv_device_set_string_feature_value(device, "ChunkSelector", chunk, fault);
  if (fault.any()) return false;
  arv_device_set_boolean_feature_value(device, "ChunkEnable", TRUE, fault);
  return !fault.any();
}

}  // namespace

AravisChunks choose_aravis_chunks(ArvCamera* camera) {
  ArvDevice* device = arv_camera_get_device(camera);
  AravisFault fault;
  AravisChunks chunks;
  if (!has_feature(device, "ChunkModeActive") || !has_feature(device, "ChunkSelector"))
    return chunks;
  arv_device_set_boolean_feature_value(device, "ChunkModeActive", TRUE, fault);
  if (!fault.any() && enable_chunk(device, "Timestamp")) {
    chunks = {.timestamp = true,
              .exposure = enable_chunk(device, "ExposureTime"),
              .frame_id = enable_chunk(device, "FrameID")};
    if (ARV_IS_GV_DEVICE(device))
      if (const guint64 ticks_hz =
              arv_gv_device_get_timestamp_tick_frequency(ARV_GV_DEVICE(device), fault);
          !fault.any() && ticks_hz > 0)
        chunks.ns_per_tick = 1e9 / static_cast<double>(ticks_hz);
    return chunks;
  }
  arv_device_set_boolean_feature_value(device, "ChunkModeActive", FALSE, fault);
  return chunks;
}

void read_aravis_chunks(ArvChunkParser* parser, ArvBuffer* buffer, const AravisChunks& chunks,
                        Frame& frame) {
  if (!arv_buffer_has_chunks(buffer)) return;
  AravisFault fault;
  const auto ticks =
      chunks.timestamp ? arv_chunk_parser_get_integer_value(parser, buffer, "ChunkTimestamp", fault)
                       : 0;
  if (!chunks.timestamp || fault.any()) return;
  if (chunks.exposure) {
    const double us = arv_chunk_parser_get_float_value(parser, buffer, "ChunkExposureTime", fault);
    if (!fault.any() && us > 0 && us < kMostExposure_us)
      frame.exposure = Duration(static_cast<std::int64_t>(us * 1e3));
  }
  // Stamps in whole nanoseconds, such as PTP's, stay exact.
  const auto whole = static_cast<std::uint64_t>(ticks) & kMostAravisTime_ns;
  const std::uint64_t ns =
      chunks.ns_per_tick == 1
          ? whole
          : static_cast<std::uint64_t>(static_cast<long double>(whole) * chunks.ns_per_tick) &
                kMostAravisTime_ns;
  frame.device_time = DeviceTime(Duration(ns) + frame.exposure / 2);
  if (!chunks.frame_id) return;
  const auto id = arv_chunk_parser_get_integer_value(parser, buffer, "ChunkFrameID", fault);
  if (!fault.any()) frame.sequence = static_cast<std::uint64_t>(id);
}

}  // namespace mixrig::device
