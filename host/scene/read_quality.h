// SPDX-License-Identifier: Apache-2.0
// The table [quality] of scene.toml. Private to this module.
#pragma once

#include "host/math/config/table.h"
#include "host/scene/quality.h"

namespace mixrig::scene {

/// Of the whole file, since a rung beside the same setting of its stage is an error.
Quality read_quality(const config::Table& root);

}  // namespace mixrig::scene
