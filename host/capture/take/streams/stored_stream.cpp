// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/stored_stream.h"

#include <utility>

#include "host/capture/take/manifest.h"
#include "host/capture/take/streams/picture_files.h"

namespace mixrig::take {
namespace fs = std::filesystem;

Result<std::unique_ptr<PictureStream>> open_stored(const fs::path& root, const StreamInfo& stream,
                                                   PixelKind kind) {
  const fs::path path = root / stream.path;
  if (is_matroska(stream)) return open_matroska(path, kind, stream.count, stream.rate_hz);
  MIXRIG_ASSIGN(NumberedName name, NumberedName::parse(path.string()));
  return std::unique_ptr<PictureStream>(
      std::make_unique<PictureFiles>([name = std::move(name), first = stream.first](int index) {
        return fs::path(name.with(first + index));
      }));
}

}  // namespace mixrig::take
