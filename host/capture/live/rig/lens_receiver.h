// SPDX-License-Identifier: Apache-2.0
// Encoders of a lens, as they come from a network.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/math/geometry/lens_table.h"

namespace mixrig::live {

/// For one thread.
class LensReceiver {
 public:
  virtual ~LensReceiver() = default;
  /// Waits for values, `timeout` at most; nullopt where none came. Does not allocate. Errors:
  /// kDevice where none can come any longer.
  virtual Result<std::optional<geometry::LensEncoders>> next(Duration timeout) = 0;
  /// What was wrong with what came so far, for a warning; empty where nothing was.
  virtual std::string trouble() const = 0;
};

/// The functions of a protocol. `uri`: with its scheme.
struct LensProtocol {
  /// Pure. Errors: kUsage for a URI that is not valid.
  Result<void> (*check)(const std::string& uri) = nullptr;
  /// Errors: those of check(); kDevice.
  Result<std::unique_ptr<LensReceiver>> (*open)(const std::string& uri) = nullptr;
};

}  // namespace mixrig::live
