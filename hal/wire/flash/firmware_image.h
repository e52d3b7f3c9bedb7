// SPDX-License-Identifier: Apache-2.0
// Firmware images on the host: reading, checking, writing.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/protocol/image_header.h"
#include "hal/base/result.h"

namespace mixrig::device {

struct FirmwareImage {
  std::vector<std::uint8_t> bytes;
  protocol::ImageHeader header;
};

/// Rules for an image, besides its checksum.
struct ImageRules {
  bool this_protocol = true;  ///< its message table must be this host's
};

/// Checks magic, size, CRC, board and message table. `name` is for the error line. Errors: kFormat.
Result<FirmwareImage> check_image(std::vector<std::uint8_t> bytes, const std::string& name,
                                  ImageRules rules = {});
/// Reads and checks a file of at most protocol::kMaxImage bytes. Errors: kNotFound, kIo, kFormat.
Result<FirmwareImage> load_image(const std::string& path, ImageRules rules = {});
/// Whether `flash` would boot: it holds a mixrig image with a valid checksum, or another program
/// with a vector table. The remains of an interrupted flashing are neither.
bool worth_keeping(std::span<const std::uint8_t> flash);
/// Reads a whole file of any content, at most protocol::kMaxImage bytes.
Result<std::vector<std::uint8_t>> read_image_file(const std::string& path);
/// Writes the whole file or nothing (write_file); makes the folder where it is missing.
Result<void> write_image_file(const std::string& path, std::span<const std::uint8_t> bytes);
/// Returns the version as text, such as "0.1.0".
std::string version_text(const protocol::ImageHeader& header);

}  // namespace mixrig::device
