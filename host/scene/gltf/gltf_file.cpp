// SPDX-License-Identifier: Apache-2.0
// tinygltf with limits: nesting depth, and files only from the model's own folder.
#include "host/scene/gltf/gltf_file.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <fstream>

namespace mixrig::scene {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 30;
constexpr int kMaxNesting = 64;
constexpr std::size_t kGlbHeaderBytes = 20;

bool is_glb(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kGlbHeaderBytes && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

/// Whether JSON is nested too deep. tinygltf parses it by recursion, so this is checked first.
bool is_nested_too_deep(std::span<const std::uint8_t> json) {
  int depth = 0;
  bool in_text = false, escaped = false;
  for (const std::uint8_t c : json) {
    if (in_text) {
      in_text = escaped || c != '"';
      escaped = !escaped && c == '\\';
    } else if (c == '"') {
      in_text = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kMaxNesting) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

std::span<const std::uint8_t> json_of(std::span<const std::uint8_t> bytes) {
  if (!is_glb(bytes)) return bytes;
  std::uint32_t length = 0;  // little-endian, like every machine that this runs on
  std::memcpy(&length, bytes.data() + 12, sizeof(length));
  const auto rest = bytes.subspan(kGlbHeaderBytes);
  return rest.first(std::min<std::size_t>(length, rest.size()));
}

/// Returns the file inside `folder` that a URI names; empty if it is outside or does not exist.
fs::path resolve(const std::string& name, const fs::path& folder) {
  std::error_code error;
  const fs::path root = fs::weakly_canonical(folder, error);
  const fs::path file = fs::weakly_canonical(fs::path(name), error);
  const fs::path inside = file.lexically_relative(root);
  if (error || inside.empty() || *inside.begin() == "..") return {};
  return fs::is_regular_file(file, error) ? file : fs::path();
}

bool exists(const std::string& name, void* folder) {
  return !resolve(name, *static_cast<fs::path*>(folder)).empty();
}

bool read_file(std::vector<unsigned char>* out, std::string* error, const std::string& name,
               void* folder) {
  const fs::path path = resolve(name, *static_cast<fs::path*>(folder));
  std::error_code size_error;
  if (path.empty() || fs::file_size(path, size_error) > kMaxFileBytes || size_error) {
    *error = "not readable";
    return false;
  }
  std::ifstream file(path, std::ios::binary);
  out->assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
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

std::string first_line(const std::string& text) {
  return text.substr(0, std::min<std::size_t>(text.find('\n'), 300));
}

}  // namespace

Error bad_gltf(const std::string& why) { return Error{ErrorCode::kFormat, why}; }

Result<GltfFile> parse_gltf(std::span<const std::uint8_t> bytes, const fs::path& folder) {
  if (bytes.size() > kMaxFileBytes) return bad_gltf("larger than 1 GiB");
  if (is_nested_too_deep(json_of(bytes))) return bad_gltf("its JSON is nested too deep");
  GltfFile file;
  fs::path root = folder;
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_picture, &file.pictures);
  loader.SetFsCallbacks(
      {exists, [](const std::string& name, void*) { return name; }, read_file, nullptr, &root});
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  try {
    const bool parsed =
        is_glb(bytes) ? loader.LoadBinaryFromMemory(&file.gltf, &error, &warning, bytes.data(),
                                                    size, root.string())
                      : loader.LoadASCIIFromString(&file.gltf, &error, &warning,
                                                   reinterpret_cast<const char*>(bytes.data()),
                                                   size, root.string());
    if (!parsed) return bad_gltf(error.empty() ? "not a glTF 2.0 file" : first_line(error));
  } catch (const std::exception& e) {
    return bad_gltf(first_line(e.what()));
  }
  file.pictures.resize(file.gltf.images.size());
  return file;
}

}  // namespace mixrig::scene
