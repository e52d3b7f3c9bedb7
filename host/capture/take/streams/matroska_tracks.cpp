// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/matroska_tracks.h"

#include <algorithm>
#include <cctype>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/capture/take/streams/ebml.h"

namespace mixrig::take {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{4} << 20;
constexpr std::size_t kBitmapHeaderBytes = 40;  ///< before the codec's own data in VFW tracks

/// Printable characters alone.
std::string words_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min<std::size_t>(bytes.size(), 40)))
    if (std::isprint(byte) != 0) text += static_cast<char>(byte);
  return text;
}

Size size_of(std::span<const std::uint8_t> video) {
  const auto side = [](std::span<const std::uint8_t> body) {
    return static_cast<int>(std::min<std::uint64_t>(unsigned_of(body), 1U << 16U));
  };
  Size size;
  Elements parts(video);
  for (Element part; parts.next(part);) {
    if (part.id == kPixelWidth) size.width = side(part.body);
    if (part.id == kPixelHeight) size.height = side(part.body);
  }
  return size;
}

std::string codec_words(const std::string& id) {
  struct Row {
    const char *id, *words;
  };
  constexpr Row kKnown[] = {{"V_FFV1", "FFV1"},
                            {"V_MPEG4/ISO/AVC", "H.264"},
                            {"V_MPEGH/ISO/HEVC", "H.265"},
                            {"V_MJPEG", "MJPEG"},
                            {"V_AV1", "AV1"},
                            {"V_VP8", "VP8"},
                            {"V_VP9", "VP9"},
                            {"V_UNCOMPRESSED", "raw pictures"},
                            {"V_PRORES", "ProRes"}};
  for (const Row& row : kKnown)
    if (id == row.id) return row.words;
  return id;
}

/// One entry of the list of tracks; nullopt where it is not of pictures.
std::optional<MatroskaTrack> parse_entry(std::span<const std::uint8_t> body) {
  MatroskaTrack track;
  std::string codec;
  std::span<const std::uint8_t> own;
  std::uint64_t type = 0;
  Elements parts(body);
  for (Element part; parts.next(part);) {
    if (part.id == kTrackNumber) track.number = unsigned_of(part.body);
    if (part.id == kTrackType) type = unsigned_of(part.body);
    if (part.id == kCodecId) codec = words_of(part.body);
    if (part.id == kCodecPrivate) own = part.body;
    if (part.id == kTrackName) track.name = words_of(part.body);
    if (part.id == kVideo) track.size_px = size_of(part.body);
  }
  if (type != 1) return std::nullopt;
  track.codec = codec_words(codec);
  if (codec == "V_MS/VFW/FOURCC" && own.size() >= kBitmapHeaderBytes) {
    track.codec = words_of(own.subspan(16, 4));
    own = own.subspan(kBitmapHeaderBytes);
    if (track.codec == "MJPG") track.codec = "MJPEG";
    if (track.codec.empty()) track.codec = "raw pictures";  // no letters: a bitmap without a codec
    if (track.codec == "b16g") track.codec = kRawGray16;
  }
  if (track.codec == "FFV1") track.record.assign(own.begin(), own.end());
  return track;
}

/// The first picture of each track, from the first cluster.
void find_formats(std::span<const std::uint8_t> cluster, std::vector<MatroskaTrack>& tracks) {
  const auto take_block = [&](std::span<const std::uint8_t> body) {
    constexpr std::size_t kTimeAndFlags = 3;
    Elements block(body);
    std::uint64_t number = 0;
    if (!block.number(8, true, number) || block.rest().size() < kTimeAndFlags) return;
    for (MatroskaTrack& track : tracks)
      if (track.number == number && track.codec == "FFV1" && !track.ffv1)
        track.ffv1 = ffv1_format(track.record, block.rest().subspan(kTimeAndFlags));
  };
  Elements parts(cluster);
  for (Element part; parts.next(part);) {
    if (part.id == kSimpleBlock) take_block(part.body);
    if (part.id != kBlockGroup) continue;
    Elements group(part.body);
    for (Element inner; group.next(inner);)
      if (inner.id == kBlock) take_block(inner.body);
  }
}

struct WantedFormat {
  const char *words, *stream, *pixels;
};
WantedFormat wanted_format(PixelKind kind) {
  if (kind == PixelKind::kRgb8) return {"RGB of 8 bits", "colour", "bgr0"};
  return {"grey of 16 bits", "depth and amplitude", "gray16le"};
}

bool is_wanted(const Ffv1Format& format, PixelKind kind) {
  if (kind == PixelKind::kRgb8) return format.rgb && !format.alpha && format.bits == 8;
  return format.is_gray() && format.bits == 16;
}

}  // namespace

std::optional<std::vector<MatroskaTrack>> parse_tracks(std::span<const std::uint8_t> bytes) {
  std::optional<std::vector<MatroskaTrack>> tracks;
  Elements file(bytes);
  for (Element top; file.next(top);) {
    if (top.id != kSegment) continue;
    Elements segment(top.body);
    for (Element part; segment.next(part);) {
      if (part.id == kTracks) {
        if (!tracks) tracks.emplace();
        Elements list(part.body);
        for (Element entry; list.next(entry);)
          if (entry.id == kTrackEntry && tracks->size() < kMostTracks)
            if (auto track = parse_entry(entry.body)) tracks->push_back(*std::move(track));
      } else if (part.id == kCluster && tracks) {
        find_formats(part.body, *tracks);
        return tracks;
      }
    }
  }
  return tracks;
}

namespace {

/// Adds the blocks of a cluster; one that is laced or cut is left out.
void add_blocks(std::span<const std::uint8_t> cluster, MatroskaContents& contents) {
  std::int64_t ticks = 0;
  const auto add = [&](const Element& element) {
    if (element.is_cut) contents.is_cut = true;
    if (element.is_cut) return;
    constexpr std::size_t kTimeAndFlags = 3;
    constexpr unsigned kLacing = 0x06;
    Elements block(element.body);
    std::uint64_t number = 0;
    if (!block.number(8, true, number) || block.rest().size() < kTimeAndFlags) return;
    const auto rest = block.rest();
    if ((rest[2] & kLacing) != 0 || contents.blocks.size() >= kMostBlocks) return;
    const auto relative = static_cast<std::int16_t>(rest[0] << 8 | rest[1]);
    contents.blocks.push_back({number, ticks + relative, rest.subspan(kTimeAndFlags)});
  };
  Elements parts(cluster);
  for (Element part; parts.next(part);) {
    if (part.id == kClusterTime)
      ticks = static_cast<std::int64_t>(unsigned_of(part.body) & 0xFFFFFFFFFFFFU);
    if (part.id == kSimpleBlock) add(part);
    if (part.id != kBlockGroup) continue;
    Elements group(part.body);
    for (Element inner; group.next(inner);)
      if (inner.id == kBlock) add(inner);
  }
}

void add_attachments(std::span<const std::uint8_t> list, MatroskaContents& contents) {
  Elements files(list);
  for (Element file; files.next(file);) {
    if (file.id != kAttachedFile || contents.attachments.size() >= kMostTracks) continue;
    std::string name;
    std::span<const std::uint8_t> data;
    Elements parts(file.body);
    for (Element part; parts.next(part);) {
      if (part.id == kFileName) name = words_of(part.body);
      if (part.id == kFileData) data = part.body;
    }
    contents.attachments.emplace_back(name, data);
  }
}

}  // namespace

MatroskaContents parse_contents(std::span<const std::uint8_t> bytes) {
  MatroskaContents contents;
  contents.tracks = parse_tracks(bytes).value_or(std::vector<MatroskaTrack>());
  Elements file(bytes);
  for (Element top; file.next(top);) {
    if (top.id != kSegment) continue;
    Elements segment(top.body);
    for (Element part; segment.next(part);) {
      if (part.id == kCluster) add_blocks(part.body, contents);
      if (part.id == kAttachments) add_attachments(part.body, contents);
      if (part.id != kInfo) continue;
      Elements info(part.body);
      for (Element inner; info.next(inner);)
        if (inner.id == kTimestampScale)
          contents.tick_s = 1e-9 * static_cast<double>(unsigned_of(inner.body));
    }
  }
  return contents;
}

Result<void> check_tracks(const std::filesystem::path& path, PixelKind kind) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorCode::kIo, "cannot read '" + path.string() + "': check its rights"};
  std::vector<std::uint8_t> head(kHeadBytes);
  file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  const auto tracks = parse_tracks(head);
  if (!tracks) return {};
  const WantedFormat wanted = wanted_format(kind);
  const std::string name = path.filename().string();
  const auto bad = [&](const std::string& holds, const std::string& what_to_do) {
    return Error{ErrorCode::kFormat,
                 fmt::format("'{}' holds {}: {}", path.string(), holds, what_to_do)};
  };
  const std::string convert =
      fmt::format("convert it with ffmpeg -i {} -c:v ffv1 -pix_fmt {} {}.mkv", name, wanted.pixels,
                  path.stem().string() + "_ffv1");
  if (tracks->empty()) return bad("no pictures", "name a file of " + std::string(wanted.stream));
  if (tracks->size() > 1) {
    std::vector<std::string> codecs;
    for (const MatroskaTrack& track : *tracks) codecs.push_back(track.codec);
    return bad(fmt::format("{} streams of pictures ({})", codecs.size(), fmt::join(codecs, ", ")),
               fmt::format("make a take of a recording by mixrig import, or give each its own "
                           "file, the first one with ffmpeg -i {} -map 0:v:0 -c:v "
                           "ffv1 -pix_fmt {} stream_0.mkv",
                           name, wanted.pixels));
  }
  const MatroskaTrack& track = tracks->front();
  if (track.codec != "FFV1")
    return bad(fmt::format("{}, not FFV1 in {}", track.codec, wanted.words), convert);
  if (!track.ffv1 || is_wanted(*track.ffv1, kind)) return {};
  return bad(
      fmt::format("FFV1 in {}, not in {}", text_of(*track.ffv1), wanted.words),
      kind == PixelKind::kRgb8 ? convert : fmt::format("store {} as gray16le", wanted.stream));
}

}  // namespace mixrig::take
