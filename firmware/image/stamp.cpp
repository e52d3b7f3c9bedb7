// SPDX-License-Identifier: Apache-2.0
// Writes size and CRC into a linked image: mixrig-stamp RAW IMAGE HEADER
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "firmware/protocol/image_header.h"

namespace {

using Bytes = std::vector<std::uint8_t>;
using namespace mixrig::protocol;

bool write_file(const char* path, const std::uint8_t* data, std::size_t size) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return static_cast<bool>(out.flush());
}

bool stamp(Bytes& image) {
  ImageHeader header;
  if (image.size() < kHeaderOffset + sizeof header || image.size() > kMaxImage) return false;
  std::memcpy(&header, image.data() + kHeaderOffset, sizeof header);
  if (header.magic != kImageMagic) return false;
  image.resize((image.size() + 3) / 4 * 4, 0xFF);
  header.size = static_cast<std::uint32_t>(image.size());
  header.crc = image_crc(image);
  std::memcpy(image.data() + kHeaderOffset, &header, sizeof header);
  std::printf("image %u bytes, crc %08x, message table %08x, version %d.%d.%d\n", header.size,
              header.crc, header.table_hash, header.version[0], header.version[1],
              header.version[2]);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: mixrig-stamp RAW IMAGE HEADER\n");
    return 2;
  }
  std::ifstream in(argv[1], std::ios::binary);
  Bytes image{std::istreambuf_iterator<char>(in), {}};
  if (!stamp(image)) {
    std::fprintf(stderr, "error: %s is no firmware image\n", argv[1]);
    return 1;
  }
  const bool written = write_file(argv[2], image.data(), image.size()) &&
                       write_file(argv[3], image.data() + kHeaderOffset, sizeof(ImageHeader));
  if (!written) std::fprintf(stderr, "error: cannot write %s or %s\n", argv[2], argv[3]);
  return written ? 0 : 1;
}
