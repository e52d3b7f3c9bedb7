// SPDX-License-Identifier: Apache-2.0
// Any bytes as a stored shader program: an accepted program lies within the file.
#include <cstdlib>
#include <string_view>

#include "host/render/gles/gl/program_file.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(program_file) {
  using namespace mixrig::render::gles;
  const std::string_view file(reinterpret_cast<const char*>(data), size);
  for (const std::uint64_t key : {std::uint64_t{0}, std::uint64_t{7}}) {
    const auto binary = from_program_file(key, file);
    if (binary && binary->bytes.size() + 40 != size) std::abort();
  }
  return 0;
}
