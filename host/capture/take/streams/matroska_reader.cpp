// SPDX-License-Identifier: Apache-2.0
// Reads Matroska streams, forwards or by seeking.
#include <cmath>
#include <cstring>

#include <gst/app/gstappsink.h>
#include <gst/video/video-info.h>

#include "host/capture/take/streams/matroska.h"
#include "host/capture/take/streams/matroska_tracks.h"

namespace mixrig::take {
namespace {

struct SampleUnref {
  void operator()(GstSample* sample) const { gst_sample_unref(sample); }
};
using SamplePtr = std::unique_ptr<GstSample, SampleUnref>;

/// A damaged file may stall the demuxer; reading a valid frame never takes this long.
constexpr GstClockTime kPatience = 10 * GST_SECOND;

class MatroskaStream final : public PictureStream {
 public:
  MatroskaStream(Pipeline pipeline, GstElementPtr sink, std::filesystem::path path, PixelKind kind,
                 int count, double rate_hz)
      : pipeline_(std::move(pipeline)),
        sink_(std::move(sink)),
        path_(std::move(path)),
        kind_(kind),
        count_(count),
        rate_hz_(rate_hz) {}

  std::string name(int index) const override {
    return path_.string() + " frame " + std::to_string(index + 1);
  }

  Result<void> read(int index, Image<Rgb8>& image) override {
    return copy(index, image, PixelKind::kRgb8, [](const guint8* from, int width, Rgb8* to) {
      for (int x = 0; x < width; ++x) to[x] = {from[4 * x + 2], from[4 * x + 1], from[4 * x]};
    });
  }

  Result<void> read(int index, Image<std::uint16_t>& image) override {
    return copy(index, image, PixelKind::kGray16,
                [](const guint8* from, int width, std::uint16_t* to) {
                  for (int x = 0; x < width; ++x)
                    to[x] = static_cast<std::uint16_t>(from[2 * x] | (from[2 * x + 1] << 8));
                });
  }

  Result<void> read(int index, Image<float>&) override {
    return Error{ErrorCode::kData, name(index) + " holds integer depth steps, not metres"};
  }

 private:
  Error failure(int index, const std::string& why) const {
    return {ErrorCode::kFormat, "cannot read '" + name(index) + "': " + why};
  }

  /// Returns the frame's number from its stamp: Matroska rounds stamps to milliseconds.
  int index_of(GstSample* sample) const {
    const GstClockTime pts = GST_BUFFER_PTS(gst_sample_get_buffer(sample));
    if (!GST_CLOCK_TIME_IS_VALID(pts)) return -1;
    const double index = static_cast<double>(pts) / GST_SECOND * rate_hz_;
    return index < count_ + 1.0 ? static_cast<int>(std::lround(index)) : -1;
  }

  Result<void> seek(int index) {
    // It seeks to a quarter period after the stamp, since stamps are rounded and the previous frame
    // must have ended.
    const auto position = static_cast<gint64>((index + 0.25) / rate_hz_ * GST_SECOND);
    const auto flags = static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE);
    if (gst_element_seek_simple(pipeline_.get(), GST_FORMAT_TIME, flags, position) != 0) return {};
    return failure(index, "the file is cut short or damaged: copy it again");
  }

  /// Returns the next frame; null at the end, after an error, or if nothing comes for too long.
  SamplePtr next_sample() {
    constexpr GstClockTime kStep =
        20 * GST_MSECOND;  // an error of the demuxer does not end a sink's wait
    for (GstClockTime waited = 0; waited < kPatience; waited += kStep) {
      SamplePtr sample(gst_app_sink_try_pull_sample(GST_APP_SINK(sink_.get()), kStep));
      if (sample || gst_app_sink_is_eos(GST_APP_SINK(sink_.get())) != 0 || pipeline_.has_failed())
        return sample;
    }
    return nullptr;
  }

  Result<SamplePtr> pull(int index) {
    if (index < 0 || index >= count_)
      return Error{ErrorCode::kData,
                   "'" + path_.string() + "' has no frame " + std::to_string(index + 1)};
    constexpr int kSkipAhead = 8;  // decoding up to so many frames is faster than seeking
    if (index < next_ || index > next_ + kSkipAhead) MIXRIG_TRY(seek(index));
    for (int guard = 0; guard <= kSkipAhead + 2; ++guard) {
      SamplePtr sample = next_sample();
      if (!sample)
        return failure(index,
                       "the file ends before it or is damaged: copy it again, or correct count");
      const int got = index_of(sample.get());
      next_ = got + 1;
      if (got == index) return sample;
      if (got > index) break;
    }
    return failure(index, "its stamps do not fit rate_hz: correct it");
  }

  template <typename T, typename CopyRow>
  Result<void> copy(int index, Image<T>& image, PixelKind wanted, CopyRow copy_row) {
    if (kind_ != wanted)
      return Error{
          ErrorCode::kData,
          name(index) +
              " has another pixel format: colour is RGB of 8 bits, depth and amplitude grey of 16 "
              "bits"};
    MIXRIG_ASSIGN(const SamplePtr sample, pull(index));
    GstVideoInfo info;
    GstMapInfo map;
    if (gst_video_info_from_caps(&info, gst_sample_get_caps(sample.get())) == 0)
      return failure(index, "no picture: copy the file again");
    GstBuffer* buffer = gst_sample_get_buffer(sample.get());
    if (gst_buffer_map(buffer, &map, GST_MAP_READ) == 0)
      return failure(index, "no memory: close other programs");
    const Size size{info.width, info.height};
    const auto stride = static_cast<std::size_t>(info.stride[0]);
    const bool whole = !size.empty() && map.size >= info.size;
    if (whole && image.size() != size) image.reset(size);
    for (int y = 0; whole && y < size.height; ++y)
      copy_row(map.data + static_cast<std::size_t>(y) * stride, size.width, image.row(y));
    gst_buffer_unmap(buffer, &map);
    return whole ? Result<void>() : failure(index, "a damaged frame: copy the file again");
  }

  Pipeline pipeline_;
  GstElementPtr sink_;
  std::filesystem::path path_;
  PixelKind kind_;
  int count_;
  double rate_hz_;
  int next_ = 0;
};

}  // namespace

Result<std::unique_ptr<PictureStream>> open_matroska(const std::filesystem::path& path,
                                                     PixelKind kind, int count, double rate_hz) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return Error{ErrorCode::kNotFound,
                 "cannot read '" + path.string() + "': no such file: check the path"};
  MIXRIG_TRY(check_tracks(path, kind));
  const std::string description =
      std::string("filesrc name=file ! matroskademux ! avdec_ffv1 ! video/x-raw,format=") +
      raw_format(kind) + " ! appsink name=sink sync=false max-buffers=2";
  MIXRIG_ASSIGN(Pipeline pipeline, Pipeline::create(description, path));
  GstElementPtr sink(pipeline.element("sink"));
  // A pipeline can seek only after its first frame. Its own words name its elements, which the user
  // does not know.
  if (!pipeline.play() || !pipeline.wait_for(GST_MESSAGE_ASYNC_DONE, "open"))
    return Error{ErrorCode::kFormat, "cannot open '" + path.string() +
                                         "': it is damaged, or no Matroska file of FFV1: copy or "
                                         "record it again"};
  return std::unique_ptr<PictureStream>(std::make_unique<MatroskaStream>(
      std::move(pipeline), std::move(sink), path, kind, count, rate_hz));
}

}  // namespace mixrig::take
