// SPDX-License-Identifier: Apache-2.0
// State reports to the service manager that started this process (systemd's sd_notify protocol).
#pragma once

#include <string_view>

namespace mixrig::device {

/// Sends `state`, such as "READY=1" or "WATCHDOG=1". Does nothing without a service manager
/// (NOTIFY_SOCKET). Never blocks. Returns true when it was sent.
/// It replaces libsystemd, so that a board binary does not link a library for one datagram.
bool notify_service(std::string_view state);

}  // namespace mixrig::device
