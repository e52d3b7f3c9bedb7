// SPDX-License-Identifier: Apache-2.0
#include "tests/board/screen.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "host/math/image_io/image_io.h"
#include "tests/board/bench.h"

namespace mixrig::board {
namespace {

constexpr const char* kRequest = "/host/screen/request";
constexpr const char* kPicture = "/host/screen/picture.png";

/// Writes a request for the peer, which removes it when it is done.
Result<void> ask_peer(const std::string& words) {
  const std::string made = std::string(kRequest) + ".new";
  std::ofstream(made) << words << "\n";
  std::filesystem::rename(made, kRequest);
  if (wait_until([] { return !std::filesystem::exists(kRequest); }, 60s, 50ms)) return {};
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

std::size_t differing(const Image<Rgb8>& a, const Image<Rgb8>& b, int rows) {
  if (a.size() != b.size()) return std::max(a.size().area(), b.size().area());
  std::size_t count = 0;
  for (int y = 0; y < std::min(rows, a.height()); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const Rgb8 p = a.row(y)[x], q = b.row(y)[x];
      count += std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)}) > 2;
    }
  return count;
}

Result<void> press(const std::string& key) { return ask_peer("key " + key); }

}  // namespace mixrig::board
