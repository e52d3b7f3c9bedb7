// SPDX-License-Identifier: Apache-2.0
// A driver that takes glInvalidateFramebuffer at its word: in this program the call fills what is
// dropped, so that a pass that reads it draws a wrong picture.
#pragma once

namespace mixrig::test {

/// Calls so far.
int dropped_count();

}  // namespace mixrig::test
