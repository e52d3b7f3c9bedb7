// SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf/gltf_declared.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include <nlohmann/json.hpp>

#include "host/scene/gltf/gltf_file.h"
#include "host/scene/gltf/gltf_texels.h"

namespace mixrig::scene {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

constexpr std::array<std::string_view, 4> kReadExtensions{
    "KHR_materials_emissive_strength", "KHR_materials_specular", "KHR_mesh_quantization",
    "KHR_texture_transform"};
/// Extensions that say nothing of the look.
constexpr std::array<std::string_view, 3> kSilentExtensions{"KHR_xmp_json_ld", "KHR_xmp",
                                                            "KHR_materials_variants"};

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

std::string word_of(const Json& value, std::size_t most = 100) {
  return value.is_string() ? value.get_ref<const std::string&>().substr(0, most) : std::string();
}

/// The texts of a list; an empty list where it is none.
std::vector<std::string> words_in(const Json& root, const char* key) {
  std::vector<std::string> words;
  const auto list = root.find(key);
  if (list == root.end() || !list->is_array()) return words;
  for (const Json& value : *list)
    if (const std::string word = word_of(value); !word.empty()) words.push_back(word);
  return words;
}

/// The tables of a list; other elements are left out.
std::vector<const Json*> tables_in(const Json& root, const char* key) {
  std::vector<const Json*> tables;
  const auto list = root.find(key);
  if (list == root.end() || !list->is_array()) return tables;
  for (const Json& value : *list)
    if (value.is_object()) tables.push_back(&value);
  return tables;
}

/// "%20" becomes a blank (RFC 3986, 2.1).
std::string decoded(const std::string& uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    int byte = 0;
    const char* from = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(from, from + 2, byte, 16).ptr == from + 2) {
      out += static_cast<char>(byte);
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

Result<void> check_version(const Json& root) {
  const auto asset = root.find("asset");
  const std::string version =
      asset != root.end() && asset->is_object() ? word_of(asset->value("version", Json()), 20) : "";
  if (version.empty()) return bad_gltf("names no version of glTF: export it as glTF 2.0");
  if (!version.starts_with("2.") && version != "2")
    return bad_gltf("is glTF " + version + ": export it as glTF 2.0");
  return {};
}

Result<void> check_buffers(const Json& root, const fs::path& folder) {
  for (const Json* buffer : tables_in(root, "buffers")) {
    const auto named = buffer->find("uri");
    const std::string uri = named != buffer->end() ? word_of(*named, 1000) : std::string();
    if (uri.empty() || uri.starts_with("data:")) continue;
    if (file_of_uri(uri, folder).empty())
      return bad_gltf("needs the file '" + uri.substr(0, 200) +
                      "', which is not in its folder: copy it there, or export as .glb");
  }
  return {};
}

std::vector<std::string> drawn_without(const Json& root) {
  std::vector<std::string> without;
  for (const std::string& name : words_in(root, "extensionsUsed"))
    if (!is_one_of(kReadExtensions, name) && !is_one_of(kSilentExtensions, name) &&
        picture_format_of(name).empty())
      without.push_back(name);
  std::sort(without.begin(), without.end());
  without.erase(std::unique(without.begin(), without.end()), without.end());
  return without;
}

}  // namespace

std::string picture_format_of(const std::string& extension) {
  if (extension == "EXT_texture_webp") return "WebP";
  if (extension == "EXT_texture_avif") return "AVIF";
  if (extension == "KHR_texture_basisu") return "KTX2";
  if (extension == "MSFT_texture_dds") return "DDS";
  return {};
}

fs::path file_of_uri(const std::string& uri, const fs::path& folder) {
  return file_inside((folder / decoded(uri)).string(), folder);
}

fs::path file_inside(const std::string& name, const fs::path& folder) {
  std::error_code error;
  const fs::path root = fs::weakly_canonical(folder, error);
  const fs::path file = fs::weakly_canonical(fs::path(name), error);
  const fs::path inside = file.lexically_relative(root);
  if (error || inside.empty() || *inside.begin() == "..") return {};
  return fs::is_regular_file(file, error) ? file : fs::path();
}

Result<std::vector<std::string>> check_declared(std::string_view brief,
                                                std::span<const std::uint8_t> json,
                                                std::span<const std::uint8_t> bin,
                                                const fs::path& folder) {
  const Json root = Json::parse(brief, nullptr, false);
  if (!root.is_object()) {
    const auto first =
        std::find_if(brief.begin(), brief.end(), [](unsigned char c) { return c > ' '; });
    if (first != brief.end() && *first == '{')
      return bad_gltf("is cut short or damaged: export it again");
    return bad_gltf("is no glTF file: use .gltf or .glb");
  }
  MIXRIG_TRY(check_version(root));
  for (const std::string& name : words_in(root, "extensionsRequired"))
    if (!is_one_of(kReadExtensions, name))
      return bad_gltf("needs the extension " + name + ": export without it");
  MIXRIG_TRY(check_buffers(root, folder));
  MIXRIG_TRY(check_pictures(root, json, bin, folder));
  return drawn_without(root);
}

}  // namespace mixrig::scene
