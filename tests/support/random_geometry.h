// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/stability/random_geometry.h"

namespace mixrig::test {

using estimation_bench::RandomGeometry;

}  // namespace mixrig::test
