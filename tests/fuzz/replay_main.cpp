// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target without a fuzzer: 2,000 random inputs of a fixed seed, then the files of the
// given folders, unchanged and damaged. Part of the tests of every build.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Flips bits, replaces or inserts bytes, or truncates.
Bytes damaged(Bytes bytes, std::mt19937& random) {
  for (auto changes = 1 + random() % 6; changes > 0; --changes) {
    const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(random() % (bytes.size() + 1));
    const auto kind = random() % 4;
    if (kind == 0)
      bytes.insert(here, static_cast<std::uint8_t>(random()));
    else if (here == bytes.end())
      continue;
    else if (kind == 1)
      *here = static_cast<std::uint8_t>(*here ^ 1U << random() % 8);
    else if (kind == 2)
      *here = static_cast<std::uint8_t>(random());
    else if (random() % 4 == 0)
      bytes.erase(here, bytes.end());
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kInputs = 2000, kCopies = 300;
  std::mt19937 random(1);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < kInputs; ++i) {
    bytes.resize(random() % 400);
    // Few values with many zeros resemble frames more often than uniform noise.
    const auto values = 2 + random() % 255;
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % 4 ? random() % values : 0);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  int files = 0;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      std::ifstream in(entry.path(), std::ios::binary);
      bytes.assign(std::istreambuf_iterator<char>(in), {});
      LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
      for (int copy = 0; copy < kCopies; ++copy) {
        const Bytes other = damaged(bytes, random);
        LLVMFuzzerTestOneInput(other.data(), other.size());
      }
      ++files;
    }
  }
  std::printf("%d inputs, %d files: no crash\n", kInputs, files);
}
