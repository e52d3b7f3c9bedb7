// SPDX-License-Identifier: Apache-2.0
// Any bytes as calibration.toml and as camera files of other tools. An accepted file must be
// written and read again as the same.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/calibration_file/exchange.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(calibration) {
  using namespace mixrig::calibration_file;
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const auto calibration = parse_calibration(text, "c")) {
    const std::string once = calibration_text(*calibration);
    const auto again = parse_calibration(once, "again");
    if (!again) std::abort();
  }
  (void)parse_opencv(text, "o");
  (void)parse_kalibr(text, "k");
  if (const auto camera = parse_mrcal(text, "m"))
    if (const auto again = mrcal_text(*camera); !again || !parse_mrcal(*again, "again"))
      std::abort();
  return 0;
}
