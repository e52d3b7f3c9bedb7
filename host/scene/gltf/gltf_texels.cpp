// SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf/gltf_texels.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "host/math/image_io/picture_size.h"
#include "host/scene/gltf/gltf_declared.h"
#include "host/scene/gltf/gltf_file.h"

namespace mixrig::scene {
namespace {

/// A header that lies further behind, after a large colour profile, is counted once the file is
/// parsed.
constexpr std::size_t kMostHeaderBytes = std::size_t{16} << 10;
constexpr std::size_t kMostPictures = 4096;
constexpr std::size_t kMostName = 1000;

using Bytes = std::vector<unsigned char>;

/// A number from 0 of a table; `otherwise` where it has none.
std::size_t count_in(const nlohmann::json& table, const char* key, std::size_t otherwise) {
  if (!table.is_object()) return otherwise;
  const auto value = table.find(key);
  return value != table.end() && value->is_number_unsigned() ? value->get<std::size_t>()
                                                             : otherwise;
}

const nlohmann::json& list_in(const nlohmann::json& root, const char* key) {
  static const nlohmann::json none = nlohmann::json::array();
  const auto list = root.find(key);
  return list != root.end() && list->is_array() ? *list : none;
}

std::string_view text_in(const nlohmann::json& table, const char* key) {
  const auto value = table.is_object() ? table.find(key) : table.end();
  return table.is_object() && value != table.end() && value->is_string()
             ? std::string_view(value->get_ref<const std::string&>())
             : std::string_view();
}

/// Bytes of a file of `folder` from `begin`; none where it cannot be read.
Bytes header_in_file(std::string_view uri, std::size_t begin, const std::filesystem::path& folder) {
  if (uri.size() > kMostName) return {};
  std::ifstream file(file_of_uri(std::string(uri), folder), std::ios::binary);
  file.seekg(static_cast<std::streamoff>(begin));
  Bytes bytes(kMostHeaderBytes);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// Bytes of a text "data:TYPE;base64,..." from `begin`; four letters are three bytes.
Bytes header_in_text(std::string_view text, std::size_t begin) {
  constexpr std::string_view kAny = "data:application/octet-stream;base64,";
  const std::size_t comma = text.substr(0, kMostName).find(',');
  if (comma == std::string_view::npos) return {};
  text.remove_prefix(comma + 1);
  text.remove_prefix(std::min(begin / 3 * 4, text.size()));
  Bytes bytes;
  std::string type;
  tinygltf::DecodeDataURI(
      &bytes, type, std::string(kAny) + std::string(text.substr(0, kMostHeaderBytes)), 0, false);
  bytes.erase(bytes.begin(),
              bytes.begin() + static_cast<std::ptrdiff_t>(std::min(begin % 3, bytes.size())));
  return bytes;
}

/// What a text "data:17" stands for, and what follows it.
std::string_view text_at(std::string_view place, std::span<const std::uint8_t> json) {
  std::size_t at = json.size();
  std::from_chars(place.data() + std::size_t{5}, place.data() + place.size(), at);
  const auto rest = json.subspan(std::min(at, json.size()));
  return {reinterpret_cast<const char*>(rest.data()), rest.size()};
}

/// The begin of a picture that lies in a buffer; empty where the file does not fit together.
Bytes header_in_buffer(const nlohmann::json& root, const nlohmann::json& image,
                       std::span<const std::uint8_t> json, std::span<const std::uint8_t> bin,
                       const std::filesystem::path& folder) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  const nlohmann::json &views = list_in(root, "bufferViews"), &buffers = list_in(root, "buffers");
  const std::size_t view = count_in(image, "bufferView", kNone);
  if (view >= views.size()) return {};
  const std::size_t buffer = count_in(views[view], "buffer", kNone);
  if (buffer >= buffers.size()) return {};
  const std::size_t begin = count_in(views[view], "byteOffset", 0);
  const std::size_t length = std::min(count_in(views[view], "byteLength", 0), kMostHeaderBytes);
  const std::string_view uri = text_in(buffers[buffer], "uri");
  Bytes bytes;
  if (uri.starts_with("data:")) {
    bytes = header_in_text(text_at(uri, json), begin);
  } else if (!uri.empty()) {
    bytes = header_in_file(uri, begin, folder);
  } else if (buffer == 0 && begin < bin.size()) {
    const auto part = bin.subspan(begin, std::min(length, bin.size() - begin));
    bytes.assign(part.begin(), part.end());
  }
  if (bytes.size() > length) bytes.resize(length);
  return bytes;
}

}  // namespace

Error too_many_texels() {
  return bad_gltf("its pictures have more than 268 million pixels: make them smaller");
}

void TexelCount::add(std::span<const std::uint8_t> picture) {
  if (is_too_many() || picture.empty()) return;
  if (const auto size = image_io::picture_size(picture, "picture")) texels_ += size->area();
}

void TexelCount::add_text(std::string_view text) {
  if (is_too_many() || !text.starts_with("data:image/")) return;
  add(header_in_text(text, 0));
}

Result<void> check_pictures(const nlohmann::json& root, std::span<const std::uint8_t> json,
                            std::span<const std::uint8_t> bin,
                            const std::filesystem::path& folder) {
  const nlohmann::json& images = list_in(root, "images");
  if (images.size() > kMostPictures)
    return bad_gltf("has more than 4096 pictures: join them to fewer");
  TexelCount texels;
  for (const nlohmann::json& image : images) {
    const std::string_view uri = text_in(image, "uri");
    if (uri.empty())
      texels.add(header_in_buffer(root, image, json, bin, folder));
    else if (!uri.starts_with("data:"))  // those of texts are counted before the file is parsed
      texels.add(header_in_file(uri, 0, folder));
    if (texels.is_too_many()) return too_many_texels();
  }
  return {};
}

}  // namespace mixrig::scene
