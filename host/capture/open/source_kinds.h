// SPDX-License-Identifier: Apache-2.0
// What this build can open beside takes and the devices of the core: tables of its extras, which
// host/tools makes and passes down.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/live/rig/device_kind.h"

namespace mixrig::session {

/// A kind of recording by the scheme of its URIs, "studio" of studio:walk,7.
struct SourceKind {
  std::string_view scheme;
  std::string_view uri;  ///< how it is written, for errors
  /// `options`: the URI behind its scheme and colon. Null: the extra of the name `scheme` is left
  /// out of this build.
  Result<std::unique_ptr<capture::CaptureSource>> (*open)(const std::string& options) = nullptr;
};

struct SourceKinds {
  std::vector<SourceKind> sources;
  std::vector<live::DeviceKind> devices;
};

}  // namespace mixrig::session
