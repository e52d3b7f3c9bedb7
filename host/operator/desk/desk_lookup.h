// SPDX-License-Identifier: Apache-2.0
// Looks up what a change needs, or says why it cannot be made.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/operator/desk/room_sight.h"

namespace mixrig::session {

/// Finds an entry by name. Errors: kNotFound, with the names that exist.
template <typename Named>
Result<const Named*> named(const std::vector<Named>& all, const std::string& name,
                           const char* kind) {
  std::string names;
  for (const Named& one : all) {
    if (one.name == name) return &one;
    names += (names.empty() ? "" : ", ") + one.name;
  }
  return Error{ErrorCode::kNotFound, "the scene has no " + std::string(kind) + " \"" + name +
                                         "\": it has " + (names.empty() ? "none" : names)};
}

/// Returns `from`. Errors: kData if it is null.
inline Result<const SeenFrom*> seen(const SeenFrom* from) {
  if (from != nullptr) return from;
  return Error{
      ErrorCode::kData,
      "the run has not composited a frame yet: wait for the first picture, then try again"};
}

}  // namespace mixrig::session
