// SPDX-License-Identifier: Apache-2.0
// Receives encoder values of a lens from a network.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/math/geometry/lens_table.h"

namespace mixrig::live {

/// Receives encoder values. For one thread.
class LensReceiver {
 public:
  virtual ~LensReceiver() = default;
  /// Waits for values, at most `timeout`; nullopt if none came. Does not allocate. Errors: kDevice
  /// if none can come any more.
  virtual Result<std::optional<geometry::LensEncoders>> next(Duration timeout) = 0;
  /// Describes faults in the data received so far, for a warning; empty without faults.
  virtual std::string trouble() const = 0;
};

/// The functions of a protocol. `uri` includes its scheme.
struct LensProtocol {
  /// Checks a URI. Pure. Errors: kUsage for a URI that is not valid.
  Result<void> (*check)(const std::string& uri) = nullptr;
  /// Opens the receiver. Errors: those of check(); kDevice.
  Result<std::unique_ptr<LensReceiver>> (*open)(const std::string& uri) = nullptr;
};

}  // namespace mixrig::live
