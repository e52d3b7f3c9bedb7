// SPDX-License-Identifier: Apache-2.0
// Edges of the master trigger as this host sees them on a line.
#pragma once

#include <cstdint>
#include <functional>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/camera.h"

namespace mixrig::device {

struct LineEdge {
  std::uint64_t sequence = 0;  ///< rising edges seen since start, from 0
  HostTime at{};               ///< stamped as close to the line as the system allows
};

/// Receives edges on the driver's thread. Must not block.
using EdgeSink = std::function<void(const LineEdge&)>;

/// Reports the rising edges of one line. One thread calls the methods; any thread may call
/// health().
class TriggerInput {
 public:
  virtual ~TriggerInput() = default;
  virtual Result<void> start(EdgeSink sink) = 0;
  /// Returns after the last call to the sink.
  virtual void stop() = 0;
  virtual StreamHealth health() const = 0;
};

}  // namespace mixrig::device
