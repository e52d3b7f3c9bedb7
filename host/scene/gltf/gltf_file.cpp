// SPDX-License-Identifier: Apache-2.0
// tinygltf with limits: nesting depth, and files only from the model's own folder.
#include "host/scene/gltf/gltf_file.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>

#include "host/scene/gltf/gltf_declared.h"
#include "host/scene/gltf/gltf_texels.h"

namespace mixrig::scene {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 30;
constexpr int kMaxNesting = 64;
constexpr std::size_t kMaxValues = std::size_t{2} << 20;
constexpr std::size_t kGlbHeaderBytes = 20;

bool is_glb(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kGlbHeaderBytes && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

/// Position of the quote that ends the text in JSON which begins at `at`; the size where none does.
std::size_t end_of_text(std::span<const std::uint8_t> json, std::size_t at) {
  for (std::size_t from = at; from < json.size();) {
    const void* const quote = std::memchr(json.data() + from, '"', json.size() - from);
    if (quote == nullptr) break;
    const auto end =
        static_cast<std::size_t>(static_cast<const std::uint8_t*>(quote) - json.data());
    std::size_t escapes = 0;
    while (end - escapes > at && json[end - escapes - 1] == '\\') ++escapes;
    if (escapes % 2 == 0) return end;
    from = end + 1;
  }
  return json.size();
}

/// Checks what parsers would take stack and memory for: nesting, since tinygltf parses it by
/// recursion, values, of which it keeps some hundred bytes each, and the pictures in texts. Returns
/// the JSON in which the position of its first letter stands for each text "data:...": "data:17".
Result<std::string> brief_json(std::span<const std::uint8_t> json) {
  const std::string_view text(reinterpret_cast<const char*>(json.data()), json.size());
  int depth = 0;
  std::size_t values = 0;
  TexelCount texels;
  std::string brief;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::uint8_t c = json[i];
    if (c == '"') {
      const std::size_t end = end_of_text(json, i + 1);
      const std::string_view value(text.substr(i + 1, end - i - 1));
      texels.add_text(value);
      if (texels.is_too_many()) return too_many_texels();
      if (value.starts_with("data:")) {
        brief.append(text.substr(copied, i - copied)).append("\"data:" + std::to_string(i + 1));
        copied = end;
      }
      i = end;
    } else if (c == '{' || c == '[') {
      if (++depth > kMaxNesting) return bad_gltf("its JSON is nested too deep");
    } else if (c == '}' || c == ']') {
      --depth;
    } else if (c == ',' && ++values > kMaxValues) {
      return bad_gltf("its JSON has more than 2 million values: simplify it");
    }
  }
  return brief.append(text.substr(copied));
}

std::span<const std::uint8_t> json_of(std::span<const std::uint8_t> bytes) {
  if (!is_glb(bytes)) return bytes;
  std::uint32_t length = 0;  // little-endian, like every machine that this runs on
  std::memcpy(&length, bytes.data() + 12, sizeof(length));
  const auto rest = bytes.subspan(kGlbHeaderBytes);
  return rest.first(std::min<std::size_t>(length, rest.size()));
}

/// The buffer of a .glb, behind its JSON; empty for other files.
std::span<const std::uint8_t> bin_of(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kChunkHeaderBytes = 8;
  if (!is_glb(bytes)) return {};
  const std::size_t begin = kGlbHeaderBytes + json_of(bytes).size() + kChunkHeaderBytes;
  return begin < bytes.size() ? bytes.subspan(begin) : std::span<const std::uint8_t>();
}

/// Where the files of a model are read, and how many bytes of them may still be.
struct Folder {
  fs::path path;
  std::uintmax_t left = kMaxFileBytes;
  bool is_too_large = false;
};

bool exists(const std::string& name, void* folder) {
  return !file_inside(name, static_cast<Folder*>(folder)->path).empty();
}

bool read_file(std::vector<unsigned char>* out, std::string* error, const std::string& name,
               void* user) {
  auto& folder = *static_cast<Folder*>(user);
  const fs::path path = file_inside(name, folder.path);
  std::error_code size_error;
  const std::uintmax_t size = path.empty() ? 0 : fs::file_size(path, size_error);
  if (size > folder.left) folder.is_too_large = true;
  if (path.empty() || size_error || size > folder.left) {
    *error = "not readable";
    return false;
  }
  folder.left -= size;
  out->resize(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(out->data()), static_cast<std::streamsize>(size));
  out->resize(static_cast<std::size_t>(file.gcount()));
  return true;
}

/// Keeps the bytes of an external picture. Those of a picture inside a buffer are read later, with
/// a check: tinygltf does not check that its view lies inside the buffer.
bool keep_picture(tinygltf::Image* image, int index, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void* pictures) {
  auto& kept = *static_cast<std::vector<std::vector<std::uint8_t>>*>(pictures);
  kept.resize(std::max(kept.size(), static_cast<std::size_t>(index) + 1));
  if (image->bufferView < 0) kept[static_cast<std::size_t>(index)].assign(bytes, bytes + size);
  return true;
}

/// The parser's own words name its fields, which the user does not know.
Error damaged_gltf() {
  return bad_gltf("is damaged: its parts do not fit together: export it again");
}

}  // namespace

Error bad_gltf(const std::string& why) { return Error{ErrorCode::kFormat, why}; }

Result<GltfFile> parse_gltf(std::span<const std::uint8_t> bytes, const fs::path& folder) {
  if (bytes.size() > kMaxFileBytes) return bad_gltf("larger than 1 GiB");
  MIXRIG_ASSIGN(const std::string brief, brief_json(json_of(bytes)));
  if (is_glb(bytes) && bytes[4] != 2) return bad_gltf("is glTF 1.0: export it as glTF 2.0");
  GltfFile file;
  MIXRIG_ASSIGN(file.without, check_declared(brief, json_of(bytes), bin_of(bytes), folder));
  Folder files{folder};
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_picture, &file.pictures);
  loader.SetFsCallbacks(
      {exists, [](const std::string& name, void*) { return name; }, read_file, nullptr, &files});
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  try {
    const bool parsed =
        is_glb(bytes) ? loader.LoadBinaryFromMemory(&file.gltf, &error, &warning, bytes.data(),
                                                    size, folder.string())
                      : loader.LoadASCIIFromString(&file.gltf, &error, &warning,
                                                   reinterpret_cast<const char*>(bytes.data()),
                                                   size, folder.string());
    if (files.is_too_large) return bad_gltf("its files have more than 1 GiB: make them smaller");
    if (!parsed) return damaged_gltf();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return damaged_gltf();
  }
  file.pictures.resize(file.gltf.images.size());
  return file;
}

}  // namespace mixrig::scene
