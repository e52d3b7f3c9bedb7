// SPDX-License-Identifier: Apache-2.0
// Any bytes as pose files and file lists.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/capture/take/trajectory.h"
#include "host/capture/take/tum_folder.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(trajectory) {
  using namespace mixrig;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto poses = take::parse_trajectory(text, "p"); poses && !poses->empty())
    (void)take::pose_at(*poses, poses->front().time_s, 0.1);
  if (const auto files = take::parse_file_list(text, "f"))
    for (const auto& [color, depth] : take::associate(files->files, files->files, 0.02))
      if (color < 0 || depth < 0) std::abort();
  return 0;
}
