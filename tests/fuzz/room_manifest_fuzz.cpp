// SPDX-License-Identifier: Apache-2.0
// Any bytes as manifests of scanned rooms, joined rooms and backgrounds, without their pictures.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "host/room/background/static_background.h"
#include "host/room/scan/room_file.h"
#include "tests/fuzz/target.h"
#include "tests/support/temporary_folder.h"

MIXRIG_FUZZ_TARGET(room_manifest) {
  using namespace mixrig;
  static const test::TemporaryFolder folder;
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const char* name : {"manifest.toml", "background.toml"}) (void)folder.write(name, text);
  const auto rooms = model::load_rooms(folder.path());
  const auto background = model::load_static_background(folder.path());
  if (rooms || background) std::abort();  // there are no pictures
  if (const auto manifest = model::read_manifest(folder.path());
      manifest && (manifest->views < 1 || manifest->frames < 1))
    std::abort();
  return 0;
}
