// SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf/gltf_texels.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "host/math/image_io/picture_size.h"
#include "host/scene/gltf/gltf_file.h"

namespace mixrig::scene {
namespace {

/// A header that lies further behind, after a large colour profile, is counted once the file is
/// parsed.
constexpr std::size_t kMostHeaderBytes = std::size_t{16} << 10;

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
  std::vector<unsigned char> header;
  std::string type;
  if (tinygltf::DecodeDataURI(&header, type, std::string(text.substr(0, kMostHeaderBytes)), 0,
                              false))
    add(header);
}

void TexelCount::add_buffered(const nlohmann::json& root, std::span<const std::uint8_t> bin) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  const nlohmann::json& views = list_in(root, "bufferViews");
  for (const nlohmann::json& image : list_in(root, "images")) {
    const std::size_t view = count_in(image, "bufferView", kNone);
    if (view >= views.size() || count_in(views[view], "buffer", kNone) != 0) continue;
    const std::size_t begin = std::min(count_in(views[view], "byteOffset", 0), bin.size());
    const std::size_t bytes =
        std::min({count_in(views[view], "byteLength", 0), bin.size() - begin, kMostHeaderBytes});
    add(bin.subspan(begin, bytes));
  }
}

}  // namespace mixrig::scene
