// SPDX-License-Identifier: Apache-2.0
// Opens takes: the manifest, the streams and the tables beside them.
#include <algorithm>
#include <memory>
#include <utility>

#include "host/capture/capture/pose_source.h"
#include "host/capture/take/streams/picture_files.h"
#include "host/capture/take/streams/stored_stream.h"
#include "host/capture/take/take_state.h"
#include "host/capture/take/tell_once.h"
#include "host/capture/take/tum_folder.h"
#include "host/capture/take/unfinished.h"
#include "host/math/config/table.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxManifestBytes = std::size_t{1} << 20;

/// Streams of other lengths may be of other rates, which nobody told.
std::string rate_hint(const TakeInfo& info) {
  const bool told = info.color.rate_hz > 0 && info.depth.rate_hz > 0;
  if (told || is_list(info.color) || info.color.count == info.depth.count) return {};
  return ": pictures are paired by number: give color.rate_hz and depth.rate_hz if they differ";
}

void tell_left_out(const TakeInfo& info) {
  const int longest = std::max(info.color.count, info.depth.count);
  if (longest > info.frames)
    tell_once(info.path.string() + ": " + std::to_string(longest - info.frames) +
              " frames have no partner and are left out" + rate_hint(info));
}

Result<Manifest> open_manifest(const fs::path& path) {
  std::error_code error;
  fs::path file = path;
  if (fs::is_directory(path, error)) {
    file = path / "take.toml";
    if (!fs::exists(file, error) && is_tum_folder(path)) return tum_manifest(path);
  }
  MIXRIG_ASSIGN(const std::string text, config::read_text(file, kMaxManifestBytes));
  return parse_manifest(text, file);
}

}  // namespace

Result<TumLists> TakeReader::State::read_lists() {
  TumLists lists;
  for (const auto& [stream, files] :
       {std::pair(&info().color, &lists.color), std::pair(&info().depth, &lists.depth)}) {
    const fs::path path = info().root / stream->path;
    MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxListBytes));
    MIXRIG_ASSIGN(FileList list, parse_file_list(text, path.string()));
    if (!list.guessed_unit.empty())
      tell_once(path.string() + ": times are read as " + list.guessed_unit +
                ", by their size: write seconds to be sure");
    *files = std::move(list.files);
    stream->count = static_cast<int>(files->size());
  }
  return lists;
}

Result<void> TakeReader::State::open_streams() {
  if (is_list(info().color)) {
    MIXRIG_ASSIGN(const TumLists lists, read_lists());
    const auto stream_of = [root = info().root](std::vector<StampedFile> files, bool is_depth) {
      const auto path_of = [root, files = std::move(files)](int index) {
        return root / files[static_cast<std::size_t>(index)].path;
      };
      return std::make_unique<PictureFiles>(path_of, is_depth);
    };
    color = stream_of(lists.color, false);
    depth = stream_of(lists.depth, true);
    return index_lists(lists);
  }
  MIXRIG_ASSIGN(color, open_stored(info().root, info().color, PixelKind::kRgb8));
  if (info().raw_depth.empty()) {
    MIXRIG_ASSIGN(depth, open_depth(info().root, info().depth));
  } else {
    MIXRIG_ASSIGN(RawDepth frames_of, RawDepth::open(info().root, info().depth));
    raw = std::make_unique<RawDepth>(std::move(frames_of));
  }
  if (info().amplitude) {
    MIXRIG_ASSIGN(amplitude, open_stored(info().root, *info().amplitude, PixelKind::kGray16));
  }
  if (info().depth2) {
    MIXRIG_ASSIGN(depth2, open_depth(info().root, info().depth2->depth));
    if (const auto& lit = info().depth2->amplitude) {
      MIXRIG_ASSIGN(amplitude2, open_stored(info().root, *lit, PixelKind::kGray16));
    }
  }
  return index_numbered();
}

/// Reads ticks.csv and pan_tilt.csv, which recordings of a live rig have, and the tables of a lens
/// that zooms.
Result<void> TakeReader::State::read_tables() {
  std::error_code error;
  if (const fs::path path = info().root / "ticks.csv"; fs::exists(path, error)) {
    MIXRIG_ASSIGN(const std::string text, read_rows(path));
    MIXRIG_ASSIGN(ticks, parse_ticks(text, path.string()));
  }
  if (const fs::path path = info().root / "pan_tilt.csv"; fs::exists(path, error)) {
    MIXRIG_ASSIGN(const std::string text, read_rows(path));
    MIXRIG_ASSIGN(pan_tilt, parse_pan_tilt(text, path.string()));
  }
  if (const fs::path path = info().root / kLensTable; fs::exists(path, error)) {
    MIXRIG_ASSIGN(const std::string text, read_rows(path));
    MIXRIG_ASSIGN(lens, parse_lens_samples(text, path.string()));
    info().has_lens_values = true;
  }
  const fs::path true_path = info().root / manifest.truth_path / kLensTable;
  if (info().has_truth && fs::exists(true_path, error)) {
    MIXRIG_ASSIGN(const std::string text, read_rows(true_path));
    MIXRIG_ASSIGN(true_lens, parse_true_lens(text, true_path.string(), info().target.size_px()));
  }
  const fs::path people_path = info().root / manifest.truth_path / kPeopleTable;
  if (info().has_truth && fs::exists(people_path, error)) {
    MIXRIG_ASSIGN(const std::string text, read_rows(people_path));
    MIXRIG_ASSIGN(people, parse_people(text, people_path.string()));
  }
  return {};
}

Result<TakeReader> TakeReader::open(const fs::path& path) {
  if (const std::vector<Segment> segments = segments_of(path); !segments.empty()) {
    MIXRIG_ASSIGN(auto joined, State::join(path, segments));
    return TakeReader(std::move(joined));
  }
  auto state = std::make_unique<State>();
  MIXRIG_ASSIGN(state->manifest, open_manifest(path));
  if (state->manifest.unfinished) {
    MIXRIG_ASSIGN(const WholePart part, count_whole(state->manifest));
    tell_once(text_of(part, path.string()));
  }
  MIXRIG_TRY(state->open_streams());
  MIXRIG_TRY(state->read_tables());
  if (state->info().fisheye) {
    MIXRIG_ASSIGN(state->fisheye, open_fisheye_stream(state->info(), state->manifest.unfinished));
    state->info().fisheye_rate_hz = state->fisheye->rate_hz();
  }
  state->take_times_from_ticks();
  TakeInfo& info = state->info();
  info.rate_hz = info.color.rate_hz;
  if (info.file.empty()) info.file = path;
  if (!state->manifest.without_tables) info.camera_tables = {"target", "tof", "target_from_tof"};
  if (info.tof2) info.camera_tables.insert(info.camera_tables.end(), {"tof2", "target_from_tof2"});
  state->cameras = std::make_shared<capture::RigCameras>(info);
  info.path = path;
  info.frames = static_cast<int>(state->frames.size());
  if (info.frames == 0)
    return Error{
        ErrorCode::kData,
        "take '" + path.string() + "' has no frame with colour, depth and pose: check its streams"};
  const geometry::Pose& first = state->frames.front().world_from_target;
  info.moves = std::any_of(state->frames.begin(), state->frames.end(), [&](const FrameIndex& f) {
    return capture::moved(first, f.world_from_target);
  });
  state->depth_check = DepthCheck(path.string() + ": [depth]");
  state->depth2_check = DepthCheck(path.string() + ": [depth2]");
  tell_left_out(info);
  return TakeReader(std::move(state));
}

}  // namespace mixrig::take
