// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/stored_stream.h"

#include <utility>

#include "host/capture/take/manifest.h"
#include "host/capture/take/streams/picture_files.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

Result<std::unique_ptr<PictureStream>> open_stream(const fs::path& root, const StreamInfo& stream,
                                                   PixelKind kind, bool needs_16_bits) {
  const fs::path path = root / stream.path;
  if (is_matroska(stream)) return open_matroska(path, kind, stream.count, stream.rate_hz);
  MIXRIG_ASSIGN(NumberedName name, NumberedName::parse(path.string()));
  const auto path_of = [name = std::move(name), first = stream.first](int index) {
    return fs::path(name.with(first + index));
  };
  return std::unique_ptr<PictureStream>(std::make_unique<PictureFiles>(path_of, needs_16_bits));
}

}  // namespace

Result<std::unique_ptr<PictureStream>> open_stored(const fs::path& root, const StreamInfo& stream,
                                                   PixelKind kind) {
  return open_stream(root, stream, kind, false);
}

Result<std::unique_ptr<PictureStream>> open_depth(const fs::path& root, const StreamInfo& stream) {
  return open_stream(root, stream, PixelKind::kGray16, true);
}

}  // namespace mixrig::take
