// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/matroska_tracks.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace mixrig::take {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{4} << 20;
constexpr std::size_t kBitmapHeaderBytes = 40;  ///< before the codec's own data in VFW tracks

enum ElementId : std::uint32_t {
  kSegment = 0x18538067,
  kTracks = 0x1654AE6B,
  kTrackEntry = 0xAE,
  kTrackNumber = 0xD7,
  kTrackType = 0x83,
  kCodecId = 0x86,
  kCodecPrivate = 0x63A2,
  kCluster = 0x1F43B675,
  kBlockGroup = 0xA0,
  kBlock = 0xA1,
  kSimpleBlock = 0xA3,
};

struct Element {
  std::uint32_t id = 0;
  std::span<const std::uint8_t> body;  ///< cut where the bytes end
};

/// The elements of a body, one after the other.
class Elements {
 public:
  explicit Elements(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool next(Element& out) {
    std::uint64_t id = 0, size = 0;
    if (!number(4, false, id) || !number(8, true, size)) return false;
    out.id = static_cast<std::uint32_t>(id);
    out.body = rest_.first(static_cast<std::size_t>(std::min<std::uint64_t>(size, rest_.size())));
    rest_ = rest_.subspan(out.body.size());
    return true;
  }

  /// A number of variable length, with or without the mark of its length. Only ones mean that the
  /// size is not known: the element goes on to the end.
  bool number(int most_bytes, bool without_mark, std::uint64_t& value) {
    if (rest_.empty()) return false;
    const int length = std::countl_zero(rest_[0]) + 1;
    if (length > most_bytes || rest_.size() < static_cast<std::size_t>(length)) return false;
    value = 0;
    for (int i = 0; i < length; ++i) value = (value << 8U) | rest_[static_cast<std::size_t>(i)];
    rest_ = rest_.subspan(static_cast<std::size_t>(length));
    if (!without_mark) return true;
    value &= (std::uint64_t{1} << (7 * length)) - 1;
    if (value == (std::uint64_t{1} << (7 * length)) - 1) value = ~std::uint64_t{0};
    return true;
  }
  std::span<const std::uint8_t> rest() const { return rest_; }

 private:
  std::span<const std::uint8_t> rest_;
};

std::uint64_t unsigned_of(std::span<const std::uint8_t> body) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : body.first(std::min<std::size_t>(body.size(), 8)))
    value = (value << 8U) | byte;
  return value;
}

/// Printable characters alone.
std::string words_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min<std::size_t>(bytes.size(), 40)))
    if (std::isprint(byte) != 0) text += static_cast<char>(byte);
  return text;
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
  }
  if (type != 1) return std::nullopt;
  track.codec = codec_words(codec);
  if (codec == "V_MS/VFW/FOURCC" && own.size() >= kBitmapHeaderBytes) {
    track.codec = words_of(own.subspan(16, 4));
    own = own.subspan(kBitmapHeaderBytes);
    if (track.codec == "MJPG") track.codec = "MJPEG";
    if (track.codec.empty()) track.codec = "raw pictures";  // no letters: a bitmap without a codec
    if (track.codec == "b16g") track.codec = "raw grey of 16 bits (b16g)";
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
    return bad(
        fmt::format("{} streams of pictures ({})", codecs.size(), fmt::join(codecs, ", ")),
        fmt::format("give each its own file, the first one with ffmpeg -i {} -map 0:v:0 -c:v "
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
