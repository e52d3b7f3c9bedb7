// SPDX-License-Identifier: Apache-2.0
// An X server without a screen (Xvfb), which writes its picture into a file.
#pragma once

#include <cstdlib>
#include <string>

#include "hal/base/image.h"
#include "tests/support/child_process.h"
#include "tests/support/progress.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::viewfinder {

inline constexpr Size kScreen{640, 480};

inline bool has_xvfb() { return std::system("command -v Xvfb >/dev/null 2>&1") == 0; }

/// An X server on a display that it finds free.
class Xvfb {
 public:
  Xvfb()
      : server_({"Xvfb", "-displayfd", "1", "-screen", "0", "640x480x24", "-fbdir",
                 folder_.path().string(), "-nolisten", "tcp", "-nocursor"},
                120, (folder_ / "display").string(), (folder_ / "errors").string()) {}
  /// Name of the display, such as ":7"; empty where the server does not start.
  std::string display() const {
    std::string number;
    test::comes_true([&] {
      number = test::read_bytes(folder_ / "display");
      return number.ends_with('\n');
    });
    return number.empty() ? number : ":" + number.substr(0, number.size() - 1);
  }
  /// The screen, from the server's file in the format of xwd(1): a header of big-endian words,
  /// colours of twelve bytes each, and pixels of four.
  Image<Rgb8> screen() const {
    const std::string bytes = test::read_bytes(folder_ / "Xvfb_screen0");
    const auto word = [&](std::size_t index) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | static_cast<std::uint8_t>(bytes.at(4 * index + i));
      return value;
    };
    Image<Rgb8> out({static_cast<int>(word(4)), static_cast<int>(word(5))});
    const std::size_t first = word(0) + 12 * word(19), line = word(12);
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x) {
        const std::size_t at =
            first + static_cast<std::size_t>(y) * line + 4 * static_cast<std::size_t>(x);
        const auto byte = [&](std::size_t i) {
          return static_cast<std::uint8_t>(bytes.at(at + i));
        };
        out.at(x, y) = {byte(2), byte(1), byte(0)};
      }
    return out;
  }

 private:
  test::TemporaryFolder folder_;
  test::ChildProcess server_;
};

}  // namespace mixrig::viewfinder
