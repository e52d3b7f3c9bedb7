// SPDX-License-Identifier: Apache-2.0
// Sources and devices of the extras in this build: tables that host/tools makes and passes down.
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
  std::string_view uri;  ///< form of the URI, for errors
  /// Opens a source; `options` is the URI after its scheme and colon. Null: the extra named
  /// `scheme` is left out of this build.
  Result<std::unique_ptr<capture::CaptureSource>> (*open)(const std::string& options) = nullptr;
};

struct SourceKinds {
  std::vector<SourceKind> sources;
  std::vector<live::DeviceKind> devices;
};

}  // namespace mixrig::session
