// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/estimation_bench/random_geometry.h"

namespace mixrig::test {

using estimation_bench::RandomGeometry;

}  // namespace mixrig::test
