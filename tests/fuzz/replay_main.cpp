// SPDX-License-Identifier: Apache-2.0
// A fuzz target without a fuzzer: some thousand inputs of a fixed seed, and those of a folder where
// one is given. Part of the tests of every build.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  constexpr int kInputs = 2000;
  std::mt19937 random(1);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < kInputs; ++i) {
    bytes.resize(random() % 400);
    // Few values, with many zeros, look like frames oftener than noise does.
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
      ++files;
    }
  }
  std::printf("%d inputs, %d files: no crash\n", kInputs, files);
}
