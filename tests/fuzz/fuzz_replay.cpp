// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target without a fuzzer: 2,000 random inputs of a fixed seed, then the files of the
// given folders, unchanged and damaged. Part of the tests of every build.
// usage: fuzz_replay TARGET [FOLDER ...]
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string_view>
#include <vector>

#include "tests/fuzz/target.h"

namespace {

/// Targets by name. The files of the targets fill it before main().
std::map<std::string_view, mixrig::fuzz::Target>& targets() {
  static std::map<std::string_view, mixrig::fuzz::Target> all;
  return all;
}

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

constexpr int kInputs = 2000, kCopies = 300;

void run_random(mixrig::fuzz::Target target, std::mt19937& random) {
  Bytes bytes;
  for (int i = 0; i < kInputs; ++i) {
    bytes.resize(random() % 400);
    // Few values with many zeros resemble frames more often than uniform noise.
    const auto values = 2 + random() % 255;
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % 4 ? random() % values : 0);
    target(bytes.data(), bytes.size());
  }
}

void run_file(mixrig::fuzz::Target target, const std::filesystem::path& path,
              std::mt19937& random) {
  std::ifstream in(path, std::ios::binary);
  const Bytes bytes{std::istreambuf_iterator<char>(in), {}};
  target(bytes.data(), bytes.size());
  for (int copy = 0; copy < kCopies; ++copy) {
    const Bytes other = damaged(bytes, random);
    target(other.data(), other.size());
  }
}

}  // namespace

bool mixrig::fuzz::add_target(const char* name, Target target) {
  return targets().emplace(name, target).second;
}

int main(int argc, char** argv) {
  const auto found = targets().find(argc > 1 ? argv[1] : "");
  if (found == targets().end()) {
    std::fprintf(stderr, "fuzz_replay: name one of these targets:");
    for (const auto& [name, target] : targets()) std::fprintf(stderr, " %s", name.data());
    std::fprintf(stderr, "\n");
    return 2;
  }
  std::mt19937 random(1);
  run_random(found->second, random);
  int files = 0;
  for (int i = 2; i < argc; ++i)
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      run_file(found->second, entry.path(), random);
      ++files;
    }
  std::printf("%d inputs, %d files: no crash\n", kInputs, files);
}
