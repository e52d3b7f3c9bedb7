// SPDX-License-Identifier: Apache-2.0
// Tells the service manager that started the command that composites come.
#pragma once

#include <memory>

#include "hal/base/clock.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::tools {

/// With the first composite the service is ready; then the watchdog hears of it at most once a
/// second, while composites come and are handed out. Null where no service manager listens
/// (NOTIFY_SOCKET). `clock` outlives it.
std::unique_ptr<output::CompositeSink> make_service_sink(const Clock& clock);

}  // namespace mixrig::tools
