// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/program_file.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace mixrig::render::gles {
namespace {

constexpr std::string_view kMagic = "mixrigp1";
constexpr std::size_t kMostBytes = std::size_t{16} << 20;

/// Header before the bytes, in this machine's byte order, for which a binary is.
struct Header {
  std::array<char, 8> magic{};
  std::uint64_t key = 0, size = 0, checksum = 0, format = 0;
};

std::uint64_t fnv(std::string_view bytes, std::uint64_t hash = 0xcbf29ce484222325U) {
  for (const char c : bytes) hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001b3U;
  return hash;
}

std::uint64_t checksum_of(std::uint64_t format, std::string_view bytes) {
  return fnv(bytes, fnv(std::to_string(format)));
}

}  // namespace

std::uint64_t program_key(std::initializer_list<std::string_view> texts) {
  std::uint64_t hash = fnv({});
  for (const std::string_view text : texts)
    hash = fnv(text, fnv(std::to_string(text.size()), hash));
  return hash;
}

std::string to_program_file(std::uint64_t key, const ProgramBinary& binary) {
  Header header{.key = key,
                .size = binary.bytes.size(),
                .checksum = checksum_of(binary.format, binary.bytes),
                .format = binary.format};
  std::memcpy(header.magic.data(), kMagic.data(), kMagic.size());
  std::string file(sizeof header, '\0');
  std::memcpy(file.data(), &header, sizeof header);
  return file.append(binary.bytes);
}

std::optional<ProgramBinary> from_program_file(std::uint64_t key, std::string_view file) {
  Header header;
  if (file.size() <= sizeof header || file.size() > kMostBytes) return std::nullopt;
  std::memcpy(&header, file.data(), sizeof header);
  const std::string_view bytes = file.substr(sizeof header);
  if (std::string_view(header.magic.data(), header.magic.size()) != kMagic || header.key != key ||
      header.size != bytes.size() || header.checksum != checksum_of(header.format, bytes) ||
      header.format > UINT32_MAX)
    return std::nullopt;
  return ProgramBinary{static_cast<std::uint32_t>(header.format), bytes};
}

std::filesystem::path program_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  std::filesystem::path base;
  if (cache != nullptr && *cache == '/')
    base = cache;
  else if (home != nullptr && *home == '/')
    base = std::filesystem::path(home) / ".cache";
  return base.empty() ? base : base / "mixrig" / "programs";
}

std::string read_program_file(const std::filesystem::path& path) {
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (code || size > kMostBytes) return {};
  std::string file(size, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(file.data(), static_cast<std::streamsize>(size));
  if (!in) return {};
  return file;
}

}  // namespace mixrig::render::gles
