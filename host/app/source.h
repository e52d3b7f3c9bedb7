// SPDX-License-Identifier: Apache-2.0
// Where frames come from: a recorded take, the virtual studio rendered on the fly, live devices.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "hal/base/result.h"
#include "host/take/take.h"

namespace mixrig::app {

/// Frames of a source that ends when its devices do.
inline constexpr int kEndless = std::numeric_limits<int>::max();

/// Frames by number, 1..info().frames, which is kEndless for live devices. Not thread-safe.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const take::TakeInfo& info() const = 0;
  /// False when the source has ended: nothing was read.
  /// Errors: kData, whatever is wrong with the frame: the source itself was fine when it opened.
  virtual Result<bool> read(int number, take::TakeFrame& frame) = 0;
  /// Call after read() of the same frame, and only where info().has_truth. Errors as read.
  virtual Result<void> read_truth(int number, take::TruthFrame& truth) = 0;
  /// What live devices tell of themselves; null where there are none.
  virtual nlohmann::json report() const { return nullptr; }
};

/// Opens "take:DIR" or, where the studio is built in, "studio[:scenario,seed,rig,...]".
/// Errors: kUsage for another name; those of the take.
Result<std::unique_ptr<FrameSource>> open_source(const std::string& uri);

/// Opens a take folder or manifest. Errors: those of TakeReader::open.
Result<std::unique_ptr<FrameSource>> open_take_source(const std::filesystem::path& path);

}  // namespace mixrig::app
