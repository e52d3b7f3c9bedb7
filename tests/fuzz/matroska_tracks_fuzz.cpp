// SPDX-License-Identifier: Apache-2.0
// Any bytes as the head of a Matroska file, as FFV1 records and frames, and as a file that was cut
// off.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "host/capture/take/streams/ffv1_format.h"
#include "host/capture/take/streams/matroska_end.h"
#include "host/capture/take/streams/matroska_tracks.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(matroska_tracks) {
  using namespace mixrig;
  const std::span<const std::uint8_t> bytes(data, size);
  if (const auto tracks = take::parse_tracks(bytes); tracks && tracks->size() > take::kMostTracks)
    std::abort();
  for (const auto& format : {take::ffv1_format(bytes, {}), take::ffv1_format({}, bytes)})
    if (format && take::text_of(*format).empty()) std::abort();
  const int file = ::memfd_create("cut", 0);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  const auto end = take::find_matroska_end("/proc/self/fd/" + std::to_string(file));
  ::close(file);
  if (!end || end->bytes < 0 || end->bytes > static_cast<std::int64_t>(size) || end->frames < 0)
    std::abort();
  return 0;
}
