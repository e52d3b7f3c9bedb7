// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/device_kind.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/capture/live/rig/devices.h"

namespace mixrig::live {

Error extra_left_out(const std::string& what, std::string_view extra) {
  return {
      ErrorCode::kUnsupported,
      fmt::format("{}: this build is without the extra \"{}\": build mixrig with it in the CMake "
                  "list MIXRIG_EXTRAS",
                  what, extra)};
}

DeviceOpener::DeviceOpener(Clock& clock, std::vector<Recording> recordings,
                           std::span<const DeviceKind> kinds)
    : clock_(clock), recordings_(std::move(recordings)) {
  for (const DeviceKind& kind : kinds)
    kinds_.push_back({kind, kind.make != nullptr ? kind.make(clock) : nullptr});
}

const DeviceOpener::Kind* DeviceOpener::kind_of(const std::string& scheme) const {
  const auto found = std::find_if(kinds_.begin(), kinds_.end(),
                                  [&](const Kind& k) { return k.kind.scheme == scheme; });
  return found != kinds_.end() ? &*found : nullptr;
}

std::string DeviceOpener::known_uris(std::string_view DeviceKind::*uri) const {
  std::string text;
  for (const Kind& kind : kinds_)
    if (!(kind.kind.*uri).empty()) text += std::string(kind.kind.*uri) + ", ";
  return text;
}

std::vector<FoundCamera> DeviceOpener::find() {
  std::vector<FoundCamera> found;
  for (const Kind& kind : kinds_)
    if (kind.driver)
      for (FoundCamera& camera : kind.driver->find()) found.push_back(std::move(camera));
  return found;
}

Result<LensProtocol> DeviceOpener::lens(const std::string& uri) const {
  const Kind* kind = kind_of(uri.substr(0, uri.find(':')));
  if (kind != nullptr && kind->kind.left_out()) return extra_left_out(uri, kind->kind.extra);
  if (kind == nullptr || kind->kind.lens.open == nullptr)
    return Error{ErrorCode::kUsage, "'" + uri + "' is not a lens: use " +
                                        known_uris(&DeviceKind::lens_uri) + "or leave out [lens]"};
  MIXRIG_TRY(kind->kind.lens.check(uri));
  return kind->kind.lens;
}

}  // namespace mixrig::live
