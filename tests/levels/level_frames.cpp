// SPDX-License-Identifier: Apache-2.0
// Composites the analytic room, to compare builds for different processors. usage:
// - level_frames FILE               composites and writes all images
// - level_frames FILE --most LEVEL  limits the instruction set to this level of those in the
//   program
// - level_frames FILE FILE          compares two such files; exit status 1 beyond the bounds
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <vector>

#include "host/render/cpu/compositor_cpu.h"
#include "tests/gl/room_setup.h"

namespace mixrig::test {
namespace {

struct Case {
  const char* name;
  Size view, tof;
  double camera_x_m;  ///< away from where the background was learned
};
constexpr Case kCases[] = {{"still, ToF 512x424", {640, 512}, {512, 424}, 0},
                           {"moved, ToF 256x212", {640, 512}, {256, 212}, 0.2},
                           {"still, ToF 176x144", {640, 512}, {176, 144}, 0}};

template <typename T>
void write(std::ofstream& file, const Image<T>& image) {
  for (int y = 0; y < image.height(); ++y)
    file.write(reinterpret_cast<const char*>(image.row(y)),
               static_cast<std::streamsize>(sizeof(T)) * image.width());
}
template <typename T>
std::vector<T> read(std::ifstream& file, Size size) {
  std::vector<T> values(static_cast<std::size_t>(size.area()));
  file.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
  return values;
}

int composite(const char* path, std::string_view most) {
  std::ofstream file(path, std::ios::binary);
  for (const Case& c : kCases) {
    const RoomSetup room({.view = c.view, .tof = c.tof, .lens_k1 = -0.05});
    auto compositor = render::make_cpu_compositor(room.setup, 2, most);
    render::FrameInput input = room.frame();
    input.world_from_target.translation_m.x() = c.camera_x_m;
    render::FrameOutput output;
    if (!compositor || !(*compositor)->compose(input, output)) return 1;
    write(file, output.color);
    write(file, output.mixed_depth_m);
    write(file, output.segmented_depth_m);
    write(file, output.matte);
  }
  std::printf("level_frames: %s\n", render::cpu_vectors(most).c_str());
  if (file.flush()) return 0;
  std::fprintf(stderr, "level_frames: %s cannot be written\n", path);
  return 1;
}

/// Differences of two images: share of the values that differ at all, and by more than `jump`, in
/// percent; mean square and largest difference.
struct Difference {
  double differs_pct = 0, jumps_pct = 0, mean_square = 0, largest = 0;
};
template <typename T>
Difference next(std::ifstream& file_a, std::ifstream& file_b, Size size, double jump) {
  const auto a = read<T>(file_a, size), b = read<T>(file_b, size);
  Difference out;
  const double share = 1 / static_cast<double>(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    if (!(d <= 0)) out.differs_pct += 100 * share;
    if (!(d <= jump)) out.jumps_pct += 100 * share;
    out.mean_square += share * d * d;
    out.largest = std::max(out.largest, d);
  }
  return out;
}

/// Compares two files within bounds. A product that is fused with a sum is not rounded itself: last
/// bits differ, and a pixel between two surfaces may take the other one. The bounds allow for a few
/// such pixels.
bool compare(std::ifstream& a, std::ifstream& b, const Case& c) {
  constexpr double kLeastColorDb = 70, kMostJumpsPct = 0.01, kJumpM = 1e-3, kJumpByte = 2;
  const auto color = next<std::uint8_t>(a, b, {3 * c.view.width, c.view.height}, kJumpByte);
  const auto mixed = next<float>(a, b, c.view, kJumpM), people = next<float>(a, b, c.view, kJumpM);
  const auto matte = next<std::uint8_t>(a, b, c.view, kJumpByte);
  const double color_db =
      color.mean_square > 0 ? 10 * std::log10(255.0 * 255.0 / color.mean_square) : 100;
  const bool same =
      color.differs_pct + mixed.differs_pct + people.differs_pct + matte.differs_pct == 0;
  const bool good = a && b && color_db >= kLeastColorDb && mixed.jumps_pct <= kMostJumpsPct &&
                    people.jumps_pct <= kMostJumpsPct && matte.jumps_pct <= kMostJumpsPct;
  std::printf("  %s: ", c.name);
  if (good && same) {
    std::printf("the same bits\n");
    return true;
  }
  std::printf(
      "%.4f %% of the colour bytes differ, by %.0f at most (%.1f dB), %.4f %% of the matte; "
      "%.1f %% of the depths, by %.6f mm at most, %.4f %% and people's %.4f %% by more than 1 "
      "mm%s\n",
      color.differs_pct, color.largest, color_db, matte.differs_pct, mixed.differs_pct,
      1000 * mixed.largest, mixed.jumps_pct, people.jumps_pct, good ? "" : ": TOO FAR APART");
  return good;
}

int compare(const char* path_a, const char* path_b) {
  std::ifstream a(path_a, std::ios::binary), b(path_b, std::ios::binary);
  bool good = true;
  for (const Case& c : kCases) good = compare(a, b, c) && good;
  return good ? 0 : 1;
}

}  // namespace
}  // namespace mixrig::test

int main(int argc, char** argv) {
  if (argc == 2) return mixrig::test::composite(argv[1], {});
  if (argc == 4 && std::string_view(argv[2]) == "--most")
    return mixrig::test::composite(argv[1], argv[3]);
  if (argc == 3) return mixrig::test::compare(argv[1], argv[2]);
  std::fprintf(stderr, "usage: level_frames FILE [FILE | --most LEVEL]\n");
  return 2;
}
