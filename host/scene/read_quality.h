// SPDX-License-Identifier: Apache-2.0
// The table [quality] of scene.toml. Private to this module.
#pragma once

#include "host/math/config/table.h"
#include "host/scene/quality.h"

namespace mixrig::scene {

/// Reads [quality]; `root` is the whole file, since keys of other tables with this meaning in
/// earlier versions are errors that say what to write.
Quality read_quality(const config::Table& root);

}  // namespace mixrig::scene
