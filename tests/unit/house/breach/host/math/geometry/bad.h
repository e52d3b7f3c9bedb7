// SPDX-License-Identifier: Apache-2.0
// Breaks the dependency rule on purpose: the test of the rule must find it.
#include <opencv2/core.hpp>

#include "host/render/x.h"
