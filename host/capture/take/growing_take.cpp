// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/growing_take.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "hal/base/partial_path.h"
#include "host/capture/take/bracket_files.h"
#include "host/capture/take/disk_sync.h"
#include "host/capture/take/frame_tables.h"
#include "host/capture/take/manifest.h"
#include "host/capture/take/streams/depth_steps.h"
#include "host/capture/take/streams/fisheye_stream.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr const char* kAnglesHead = "frame,pan_rad,tilt_rad\n";
constexpr std::size_t kMostTable_bytes = std::size_t{16} << 20;
constexpr Duration kBreak = std::chrono::seconds(1);

Result<void> make_grown_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error) return {};
  return system_error(ErrorCode::kIo, "cannot make folder '" + path.string() + "'", error.value());
}

/// Returns the first `count` lines of a text.
std::string first_lines(const std::string& text, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count && end < text.size(); ++i) {
    const std::size_t line = text.find('\n', end);
    end = line == std::string::npos ? text.size() : line + 1;
  }
  return text.substr(0, end);
}

/// Replaces a file, on the disk before it has its name.
Result<void> write_synced(const fs::path& path, const std::string& text) {
  PartialPath partial(path);
  MIXRIG_TRY(write_file(partial.path(), text));
  MIXRIG_TRY(sync_path(partial.path()));
  MIXRIG_TRY(partial.commit());
  return sync_path(path.parent_path());
}

}  // namespace

/// Tables that grow with each frame.
struct GrownTables {
  std::string angles = kAnglesHead;                       ///< pan_tilt.csv
  std::string ticks = kTicksHeader;                       ///< ticks.csv, only with a fisheye
  std::string fisheye = kFisheyeHeader;                   ///< fisheye.csv
  std::vector<BracketRow> bracket;                        ///< bracket.csv
  HostTime last_frame{}, last_picture = HostTime::min();  ///< mid-exposures
  int frames = 0, pictures = 0;
};

struct GrowingTake::State {
  fs::path folder;
  TakeInfo info;
  GrownTables grown;
  Duration shift{};  ///< added to the times if a take is continued
  bool continued = false;
  Image<std::uint16_t> steps;
  bool lit = false;  ///< its frames have amplitudes

  Result<void> begin();
  Result<void> resume();
  Result<void> copy_calibration();
  Result<void> resume_fisheye(const TakeInfo& read);
  Result<void> write_frame(const capture::Capture& frame, device::PanTiltAngles at,
                           GrownTables& into);
  Result<void> write_fisheye(const capture::Capture& frame, GrownTables& into);
  Result<void> write_bracket(std::span<const capture::BracketPlate> bracket, GrownTables& into);
  Result<void> write_tables(const GrownTables& tables);
  Result<void> write_manifest(const GrownTables& tables);
};

Result<void> GrowingTake::State::copy_calibration() {
  if (info.calibration.empty()) return {};
  MIXRIG_ASSIGN(const std::string text, config::read_text(info.calibration, kMostTable_bytes));
  info.calibration = "calibration.toml";
  return write_file(folder / info.calibration, text);
}

Result<void> GrowingTake::State::begin() {
  for (const char* name : {"color", "depth", "amplitude"})
    MIXRIG_TRY(make_grown_folder(folder / name));
  if (info.fisheye) MIXRIG_TRY(make_grown_folder(folder / "fisheye"));
  return copy_calibration();
}

/// Reads the existing take. Rows of frames that the manifest does not count are dropped.
Result<void> GrowingTake::State::resume() {
  MIXRIG_ASSIGN(const TakeReader reader, TakeReader::open(folder));
  grown.frames = reader.info().frames;
  lit = reader.info().amplitude.has_value();
  MIXRIG_ASSIGN(const std::string text,
                config::read_text(folder / "pan_tilt.csv", kMostTable_bytes));
  grown.angles = first_lines(text, grown.frames + 1);
  MIXRIG_ASSIGN(grown.bracket, read_bracket_table(folder));
  std::erase_if(grown.bracket, [&](const BracketRow& row) { return row.frame > grown.frames; });
  if (info.fisheye) MIXRIG_TRY(resume_fisheye(reader.info()));
  return copy_calibration();
}

/// Reads the existing fisheye stream, or begins one.
Result<void> GrowingTake::State::resume_fisheye(const TakeInfo& read) {
  MIXRIG_TRY(make_grown_folder(folder / "fisheye"));
  if (!read.fisheye) return {};
  continued = true;
  MIXRIG_ASSIGN(const std::string ticks, config::read_text(folder / kTicksTable, kMostTable_bytes));
  grown.ticks = first_lines(ticks, grown.frames + 1);
  MIXRIG_ASSIGN(const auto times, parse_ticks(grown.ticks, (folder / kTicksTable).string()));
  if (!times.empty()) grown.last_frame = times.rbegin()->second.mid_exposure;
  MIXRIG_ASSIGN(const std::string rows,
                config::read_text(folder / kFisheyeTable, kMostTable_bytes));
  grown.pictures = read.fisheye->count;
  grown.fisheye = first_lines(rows, grown.pictures + 1);
  MIXRIG_ASSIGN(const auto stamps,
                parse_fisheye_table(grown.fisheye, (folder / kFisheyeTable).string()));
  if (!stamps.empty()) grown.last_picture = stamps.back().mid_exposure;
  return {};
}

Result<void> GrowingTake::State::write_frame(const capture::Capture& frame,
                                             device::PanTiltAngles at, GrownTables& into) {
  const int number = ++into.frames;
  into.angles += fmt::format("{},{:.9f},{:.9f}\n", number, at.pan_rad, at.tilt_rad);
  if (info.fisheye) MIXRIG_TRY(write_fisheye(frame, into));
  const auto path = [&](const char* stream) {
    return folder / stream / fmt::format("{:06d}.png", number);
  };
  MIXRIG_TRY(image_io::write_png(path("color"), frame.plate.view()));
  to_steps(frame.depth_m, depth_steps(info), steps);
  MIXRIG_TRY(image_io::write_png(path("depth"), std::as_const(steps).view()));
  if (!lit) return {};
  to_steps(frame.amplitude, {}, steps);
  return image_io::write_png(path("amplitude"), std::as_const(steps).view());
}

/// Writes the frame's time, and its fisheye's picture if that is new.
Result<void> GrowingTake::State::write_fisheye(const capture::Capture& frame, GrownTables& into) {
  if (continued) shift = into.last_frame + kBreak - frame.mid_exposure;
  continued = false;
  into.last_frame = frame.mid_exposure + shift;
  into.ticks += tick_row(into.frames, "color", {frame.tick, into.last_frame});
  const HostTime at = frame.fisheye_mid_exposure + shift;
  if (frame.fisheye.empty() || at <= into.last_picture) return {};
  into.last_picture = at;
  into.fisheye += fisheye_row(++into.pictures, {into.frames, frame.fisheye_counter, at});
  return image_io::write_png(folder / "fisheye" / fmt::format("{:06d}.png", into.pictures),
                             frame.fisheye.view());
}

/// Writes the plates of the view whose frames were the last ones.
Result<void> GrowingTake::State::write_bracket(std::span<const capture::BracketPlate> bracket,
                                               GrownTables& into) {
  for (const capture::BracketPlate& plate : bracket) {
    into.bracket.push_back({into.frames, plate.exposure_s, plate.frames_s});
    MIXRIG_TRY(write_bracket_plate(folder, static_cast<int>(into.bracket.size()), plate.plate));
  }
  return {};
}

Result<void> GrowingTake::State::write_tables(const GrownTables& tables) {
  MIXRIG_TRY(write_file(folder / "pan_tilt.csv", tables.angles));
  if (!tables.bracket.empty())
    MIXRIG_TRY(write_file(folder / kBracketTable, bracket_text(tables.bracket)));
  if (!info.fisheye) return {};
  MIXRIG_TRY(write_file(folder / kTicksTable, tables.ticks));
  return write_file(folder / kFisheyeTable, tables.fisheye);
}

Result<void> GrowingTake::State::write_manifest(const GrownTables& tables) {
  const auto stream = [&](const char* name) {
    return StreamInfo{std::string(name) + "/%06d.png", 1, tables.frames, info.rate_hz};
  };
  TakeInfo is = info;
  is.color = stream("color"), is.depth = stream("depth");
  is.amplitude.reset(), is.fisheye.reset();
  is.depth2.reset(), is.tof2.reset();
  if (lit) is.amplitude = stream("amplitude");
  if (tables.pictures > 0)
    is.fisheye = {"fisheye/%06d.png", 1, tables.pictures, info.fisheye->rate_hz};
  is.has_poses = is.has_truth = false;
  return write_synced(folder / "take.toml", manifest_text(is));
}

GrowingTake::GrowingTake(std::unique_ptr<State> state) : state_(std::move(state)) {}
GrowingTake::GrowingTake(GrowingTake&&) noexcept = default;
GrowingTake& GrowingTake::operator=(GrowingTake&&) noexcept = default;
GrowingTake::~GrowingTake() = default;

Result<GrowingTake> GrowingTake::open(const fs::path& folder, const TakeInfo& info) {
  auto state = std::make_unique<State>();
  state->folder = folder, state->info = info;
  std::error_code error;
  const bool there = fs::exists(folder / "take.toml", error);
  MIXRIG_TRY(there ? state->resume() : state->begin());
  return GrowingTake(std::move(state));
}

int GrowingTake::frames() const { return state_->grown.frames; }

Result<void> GrowingTake::append(std::span<const capture::Capture> frames, device::PanTiltAngles at,
                                 std::span<const capture::BracketPlate> bracket) {
  State& s = *state_;
  if (frames.empty()) return {};
  if (s.grown.frames == 0) s.lit = !frames[0].amplitude.empty();
  GrownTables grown = s.grown;
  for (const capture::Capture& frame : frames) {
    if (s.lit && frame.amplitude.empty())
      return Error{ErrorCode::kData, "a frame without amplitudes in a take that has them"};
    MIXRIG_TRY(s.write_frame(frame, at, grown));
  }
  MIXRIG_TRY(s.write_bracket(bracket, grown));
  MIXRIG_TRY(s.write_tables(grown));
  MIXRIG_TRY(sync_disk_of(s.folder));  // the manifest never names what a power cut can take
  MIXRIG_TRY(s.write_manifest(grown));
  s.grown = std::move(grown);
  return {};
}

}  // namespace mixrig::take
