// SPDX-License-Identifier: Apache-2.0
// The board's screen and keyboard as a person has them: the emulated display's picture and the
// emulated keyboard's keys, through screen_peer.py, which runs beside the emulator.
#pragma once

#include <cstddef>
#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::board {

/// Whether this boot has a screen, and the peer runs.
bool has_screen();
/// The picture on the screen. Errors: kTimeout where the peer does not answer; those of read_png.
Result<Image<Rgb8>> screenshot();
/// Presses and releases a key, by its name in QEMU ("2", "q", "spc"). Errors: kTimeout.
Result<void> press(const std::string& key);

/// Number of pixels of the upper `rows` rows in which a channel differs by more than 2 of 255
/// (processors differ by up to 2); the number of all pixels where the sizes differ.
std::size_t differing(const Image<Rgb8>& a, const Image<Rgb8>& b, int rows);

}  // namespace mixrig::board
