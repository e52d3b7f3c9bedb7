// SPDX-License-Identifier: Apache-2.0
// Plans a stream's GStreamer pipeline. Pure, tested without GStreamer.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::output {

/// Layout of the raw pictures that are fed to a stream.
enum class StreamPixels { kBgrx, kBgra, kGray8, kGray16 };
std::size_t bytes_per_pixel(StreamPixels pixels);
StreamPixels pixels_of(scene::StreamOut::Picture picture);
/// Size of the stream for a size of the view: twice as wide for two pictures side by side.
Size stream_size(scene::StreamOut::Picture picture, Size view);

struct StreamNeed {
  const char *element, *package;
};

struct StreamPlan {
  /// Pipeline description with a source named "source" and an end named "end".
  std::string description;
  std::vector<std::pair<std::string, std::string>> texts;  ///< text properties of the end
  std::optional<int> port;                                 ///< integer property of the end
  std::vector<StreamNeed> needs;
  bool i420 = false;            ///< pictures must be given as I420 (i420.h)
  bool timecode = false;        ///< the format carries timecode, which pictures must be given
  bool waits = false;           ///< a file: feeding waits, no frame is dropped
  std::string host;             ///< the receiver's, or the own one of a listener; empty: none
  bool calls = false;           ///< the end calls a receiver, which may begin to listen later
  bool sends_messages = false;  ///< the element "parse" writes messages that need end_messages()
  std::string caps;  ///< caps that a receiver must be given by other means; empty: none needed
};

/// Plans a stream. Precondition: rate_hz > 0. Errors: kUsage for an invalid address, and for a
/// picture that the codec or the address cannot carry.
Result<StreamPlan> plan_stream(const scene::StreamOut& out, Size view, double rate_hz);

/// Names of these values in scene.toml.
const char* name(scene::StreamOut::Picture picture);
const char* name(scene::StreamOut::Codec codec);

}  // namespace mixrig::output
