// SPDX-License-Identifier: Apache-2.0
// State of the machine's system clock.
#pragma once

namespace mixrig {

/// Whether the kernel reports that PTP or NTP keeps the system clock synchronized, as `timedatectl`
/// shows. Any thread.
bool host_clock_is_synchronized();

}  // namespace mixrig
