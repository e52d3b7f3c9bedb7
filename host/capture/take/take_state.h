// SPDX-License-Identifier: Apache-2.0
// What an open take holds. Private to this module: take_open.cpp fills it, take_index.cpp says
// which pictures make a frame, take_reader.cpp reads them, segments/joined_takes.cpp joins takes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/capture/take/frame_pairs.h"
#include "host/capture/take/frame_tables.h"
#include "host/capture/take/manifest.h"
#include "host/capture/take/segments/segments.h"
#include "host/capture/take/streams/depth_check.h"
#include "host/capture/take/streams/depth_steps.h"
#include "host/capture/take/streams/fisheye_stream.h"
#include "host/capture/take/streams/picture_stream.h"
#include "host/capture/take/streams/raw_depth.h"
#include "host/capture/take/take.h"
#include "host/capture/take/trajectory.h"

namespace mixrig::take {

/// Of a table; 24 hours of three streams at 25 Hz are 330 MB.
inline constexpr std::size_t kMaxListBytes = std::size_t{512} << 20;

/// Index of each part of a frame in its stream.
struct FrameIndex {
  int color = 0, depth = 0, depth2 = 0;
  double time_s = 0;
  double depth_after_s = 0, depth2_after_s = 0;  ///< mid-exposures after that of colour
  geometry::Pose world_from_target;
};

/// A take of a folder of segments (segments/segments.h).
struct JoinedTake {
  std::filesystem::path path;
  int first = 1, frames = 0;  ///< number of its first frame, and how many it has
  Duration later{};           ///< added to its stamps
  double later_s = 0;         ///< added to its times
};

/// Files of the TUM lists of colour and depth.
struct TumLists {
  std::vector<StampedFile> color, depth;
};

struct TakeReader::State {
  Manifest manifest;
  std::unique_ptr<PictureStream> color, depth, amplitude;  ///< depth is null if it is raw
  std::unique_ptr<PictureStream> depth2, amplitude2;       ///< null where the take has none
  std::unique_ptr<RawDepth> raw;
  std::unique_ptr<FisheyeStream> fisheye;  ///< null where the take has none
  std::vector<FrameIndex> frames;
  /// By frame number; empty if not recorded.
  std::map<int, FrameTick> ticks;
  /// By frame number; empty if not recorded.
  std::map<int, device::PanTiltAngles> pan_tilt;
  std::vector<capture::LensSample> lens;                   ///< by time; empty if not recorded
  std::map<int, std::vector<capture::TruePerson>> people;  ///< true people by frame number
  std::map<int, capture::TrueLens> true_lens;              ///< by frame number; empty if unknown
  std::shared_ptr<const capture::RigCameras> cameras;
  Image<std::uint16_t> steps;  ///< reused from frame to frame
  DepthCheck depth_check{""}, depth2_check{""};
  std::vector<JoinedTake> joined;           ///< empty for a take that is not in segments
  std::optional<TakeReader> joined_reader;  ///< of the one that was read last
  capture::Capture joined_begin;            ///< first frame, without its pictures
  HostTime joined_end{};                    ///< mid-exposure of the last frame

  TakeInfo& info() { return manifest.info; }
  Result<void> open_streams();
  Result<TumLists> read_lists();
  std::vector<PicturePair> pair(StreamInfo stream, const StreamInfo* amplitudes);
  Result<void> index_numbered();
  Result<void> index_lists(const TumLists& lists);
  Result<std::vector<StampedPose>> read_poses();
  Result<std::string> read_rows(const std::filesystem::path& path) const;
  Result<void> read_tables();
  void take_times_from_ticks();
  static Result<std::unique_ptr<State>> join(const std::filesystem::path& folder,
                                             const std::vector<Segment>& segments);
  Result<void> add_joined(const TakeReader& reader);
  Result<const JoinedTake*> open_joined(int number);
  Result<void> read_joined(int number, capture::Capture& capture);
  Result<void> read_joined_truth(int number, capture::Truth& truth);
  void describe(int number, capture::Capture& capture) const;
  /// Reads a frame that the take has.
  Result<void> read_frame(int number, capture::Capture& frame);
  Result<void> read_steps(PictureStream& stream, int index, const Steps& meaning,
                          Image<float>& out);
  Result<void> read_depth(int index, Image<float>& out);
  Result<void> read_second_depth(int index, capture::DepthPicture& out);
  template <typename T>
  Result<void> check_size(const Image<T>& image, Size wanted, const std::string& name,
                          const char* table) const;
  std::filesystem::path truth_file(const char* what, int number) const;
};

}  // namespace mixrig::take
