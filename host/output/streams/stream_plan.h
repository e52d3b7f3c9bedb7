// SPDX-License-Identifier: Apache-2.0
// What GStreamer is told for a stream: pure, tested without it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::output {

/// Layout of the raw pictures that a stream is fed with.
enum class StreamPixels { kBgrx, kBgra, kGray8, kGray16 };
std::size_t bytes_per_pixel(StreamPixels pixels);
StreamPixels pixels_of(scene::StreamOut::Picture picture);
/// Of the stream, by that of the view: twice as wide for two pictures side by side.
Size stream_size(scene::StreamOut::Picture picture, Size view);

struct StreamNeed {
  const char *element, *package;
};

struct StreamPlan {
  std::string description;  ///< of the pipeline, whose source is "source" and whose end is "end"
  std::vector<std::pair<std::string, std::string>> texts;  ///< properties of the end
  std::optional<int> port;                                 ///< property of the end
  std::vector<StreamNeed> needs;
  bool i420 = false;      ///< pictures are given as I420 (i420.h)
  bool timecode = false;  ///< the pictures are given theirs: the format has a place for it
  bool waits = false;     ///< a file: no frame is left out
  std::string caps;       ///< of what a receiver without them must be told; empty: it need not
};

/// Errors: kUsage for an address that is none, and a picture that the codec or the address cannot
/// carry. Precondition: rate_hz > 0.
Result<StreamPlan> plan_stream(const scene::StreamOut& out, Size view, double rate_hz);

/// Words of scene.toml.
const char* name(scene::StreamOut::Picture picture);
const char* name(scene::StreamOut::Codec codec);

}  // namespace mixrig::output
