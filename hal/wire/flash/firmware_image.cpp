// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/flash/firmware_image.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "firmware/protocol/messages.h"
#include "hal/base/partial_path.h"

namespace mixrig::device {

using protocol::ImageHeader;
using protocol::kHeaderOffset;

namespace {

Error bad(const std::string& name, const std::string& why) {
  return Error{ErrorCode::kFormat, name + ": " + why + "; nothing was erased"};
}

}  // namespace

std::string version_text(const ImageHeader& header) {
  return std::to_string(header.version[0]) + "." + std::to_string(header.version[1]) + "." +
         std::to_string(header.version[2]);
}

Result<FirmwareImage> check_image(std::vector<std::uint8_t> bytes, const std::string& name,
                                  ImageRules rules) {
  FirmwareImage image;
  const bool has_header = bytes.size() >= kHeaderOffset + sizeof(ImageHeader);
  if (has_header) std::memcpy(&image.header, bytes.data() + kHeaderOffset, sizeof(ImageHeader));
  if (!has_header || image.header.magic != protocol::kImageMagic) {
    return bad(name, "is no mixrig trigger image (give firmware/trigger.bin of the build)");
  }
  if (image.header.size != bytes.size()) {
    return bad(name, "image says " + std::to_string(image.header.size) + " bytes, file has " +
                         std::to_string(bytes.size()) + ": truncated or not stamped");
  }
  if (bytes.size() % 4 != 0 || protocol::image_crc(bytes) != image.header.crc) {
    return bad(name, "checksum does not match: the file is damaged");
  }
  if (image.header.board != protocol::kBoardF405) {
    return bad(name, "is for board " + std::to_string(image.header.board) + ", this one is " +
                         std::to_string(protocol::kBoardF405));
  }
  if (rules.this_protocol && image.header.table_hash != protocol::kTableHash) {
    return bad(name, "firmware " + version_text(image.header) +
                         " uses another protocol than this host: use the image of the same "
                         "build");
  }
  image.bytes = std::move(bytes);
  return image;
}

bool worth_keeping(std::span<const std::uint8_t> flash) {
  std::uint32_t words[2] = {};
  ImageHeader header;
  if (flash.size() < kHeaderOffset + sizeof header) return false;
  std::memcpy(words, flash.data(), sizeof words);
  std::memcpy(&header, flash.data() + kHeaderOffset, sizeof header);
  if (header.magic == protocol::kImageMagic) {
    return header.size == flash.size() && protocol::image_crc(flash) == header.crc;
  }
  const bool stack_in_ram = words[0] >> 20 == 0x200 || words[0] >> 20 == 0x100;
  return stack_in_ram && words[1] >> 20 == protocol::kFlashBase >> 20;
}

Result<std::vector<std::uint8_t>> read_image_file(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) return bad(path, "is a folder (name a .bin)");
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in)
    return system_error(ErrorCode::kNotFound,
                        "cannot open image " + path + ": firmware/README.md says how it is built",
                        errno);
  const auto size = static_cast<std::int64_t>(in.tellg());
  if (size < 0 || size > static_cast<std::int64_t>(protocol::kMaxImage)) {
    return bad(path, "is larger than any image (" + std::to_string(protocol::kMaxImage) +
                         " bytes at most)");
  }
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.seekg(0);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), size)) {
    return system_error(ErrorCode::kIo, "cannot read image " + path, errno);
  }
  return bytes;
}

Result<FirmwareImage> load_image(const std::string& path, ImageRules rules) {
  MIXRIG_ASSIGN(std::vector<std::uint8_t> bytes, read_image_file(path));
  return check_image(std::move(bytes), path, rules);
}

Result<void> write_image_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  const std::filesystem::path target(path);
  std::error_code error;
  if (target.has_parent_path()) std::filesystem::create_directories(target.parent_path(), error);
  return write_file(target, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace mixrig::device
