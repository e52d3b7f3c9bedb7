// SPDX-License-Identifier: Apache-2.0
// Tells the service manager that started the command that composites arrive.
#pragma once

#include <memory>

#include "hal/base/clock.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::tools {

/// Makes a sink that reports the service as ready with the first composite, then feeds the watchdog
/// at most once a second while composites arrive. Null where no service manager listens
/// (NOTIFY_SOCKET). `clock` outlives it.
std::unique_ptr<output::CompositeSink> make_service_sink(const Clock& clock);

}  // namespace mixrig::tools
