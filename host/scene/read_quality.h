// SPDX-License-Identifier: Apache-2.0
// The table [quality] of scene.toml. Private to this module.
#pragma once

#include "host/math/config/table.h"
#include "host/scene/quality.h"

namespace mixrig::scene {

/// Of the whole file: keys of other tables that said the same in earlier versions are errors, which
/// tell what to write.
Quality read_quality(const config::Table& root);

}  // namespace mixrig::scene
