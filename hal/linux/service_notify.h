// SPDX-License-Identifier: Apache-2.0
// Words to the service manager that started this process (systemd's sd_notify protocol).
#pragma once

#include <string_view>

namespace mixrig::device {

/// Sends `state`, such as "READY=1" or "WATCHDOG=1". Nothing happens where no manager listens
/// (NOTIFY_SOCKET). Never blocks. True when it was sent.
bool notify_service(std::string_view state);

}  // namespace mixrig::device
