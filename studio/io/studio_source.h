// SPDX-License-Identifier: Apache-2.0
// The virtual studio as a source of frames, rendered as they are asked for.
#pragma once

#include <memory>
#include <string>

#include "hal/base/result.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::studio_io {

/// `words` are SCENARIO,SEED,RIG,FRAMES,WxH; those left out from the end, or empty, keep the
/// studio's defaults. SCENARIO may also be board or turn, whose words are those of
/// open_board_source. Errors: kUsage; those of Studio::create.
Result<std::unique_ptr<capture::CaptureSource>> open_studio_source(const std::string& words);

}  // namespace mixrig::studio_io
