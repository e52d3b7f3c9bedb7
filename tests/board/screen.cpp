// SPDX-License-Identifier: Apache-2.0
#include "tests/board/screen.h"

#include <filesystem>
#include <fstream>

#include "host/image_io/image_io.h"
#include "tests/board/bench.h"

namespace mixrig::board {
namespace {

constexpr const char* kRequest = "/host/screen/request";
constexpr const char* kPicture = "/host/screen/picture.png";

/// The peer removes the request when it is done.
Result<void> ask_peer(const std::string& words) {
  const std::string made = std::string(kRequest) + ".new";
  std::ofstream(made) << words << "\n";
  std::filesystem::rename(made, kRequest);
  if (wait_until([] { return !std::filesystem::exists(kRequest); }, 60s)) return {};
  return Error{ErrorCode::kTimeout, "the peer of the screen did not answer to: " + words};
}

}  // namespace

bool has_screen() { return std::filesystem::exists("/host/screen"); }

Result<Image<Rgb8>> screenshot() {
  MIXRIG_TRY(ask_peer("picture"));
  Image<Rgb8> picture;
  MIXRIG_TRY(image_io::read_rgb8(kPicture, picture));
  return picture;
}

Result<void> press(const std::string& key) { return ask_peer("key " + key); }

}  // namespace mixrig::board
