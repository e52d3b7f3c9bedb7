// SPDX-License-Identifier: Apache-2.0
#include "host/judge/latency/played_rig.h"

#include <string>
#include <system_error>

#include <fmt/format.h>

#include "hal/base/partial_path.h"

namespace mixrig::session {

Result<std::filesystem::path> write_played_rig(const std::filesystem::path& folder,
                                               const std::filesystem::path& take,
                                               std::optional<HostTime> begin) {
  std::error_code ignored;  // writing says what is wrong
  std::filesystem::create_directories(folder, ignored);
  const std::filesystem::path file = folder / "rig.toml";
  const std::string at =
      begin ? fmt::format("play_at_s = {:.6f}\n", seconds(begin->time_since_epoch())) : "";
  const std::string uri = "take:" + std::filesystem::absolute(take).string();
  MIXRIG_TRY(write_file(
      file, fmt::format("format = 1\nname = \"played\"\n{}[[camera]]\nname = \"color\"\nuri = "
                        "\"{}/color\"\n[depth]\nuri = \"{}/depth\"\n",
                        at, uri, uri)));
  return file;
}

}  // namespace mixrig::session
