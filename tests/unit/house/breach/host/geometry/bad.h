// SPDX-License-Identifier: Apache-2.0
// Breaks the dependency rule on purpose: the test of the rule must find it.
#include "host/render/x.h"
