// SPDX-License-Identifier: Apache-2.0
// Describes the state of live devices in a few lines.
#pragma once

#include <span>

#include "host/capture/capture/source_report.h"
#include "host/output/viewfinder/text_line.h"

namespace mixrig::viewfinder {

/// Writes a line for each stream (frames a second, frames lost and without a partner) and one for
/// the sets, from two reports `between_s` apart; remaining lines become empty.
void describe(const capture::SourceReport& now, const capture::SourceReport& before,
              double between_s, std::span<TextLine> lines);

/// Names the first camera that is unplugged or has failed, and what to do; empty if all are there.
void describe_fault(const capture::SourceReport& report, TextLine& fault);

}  // namespace mixrig::viewfinder
