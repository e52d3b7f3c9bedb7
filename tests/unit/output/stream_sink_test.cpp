// SPDX-License-Identifier: Apache-2.0
// Streams as ffmpeg and GStreamer's own programs receive them: size, rate, colour, alpha, depth.
// Without these programs (scripts/setup peers) the tests that need them are skipped.
#include "host/output/streams/stream_sink.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/child_process.h"
#include "tests/support/each_pixel.h"
#include "tests/support/progress.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/udp_listener.h"

namespace mixrig::output {
namespace {

using Picture = scene::StreamOut::Picture;
using Codec = scene::StreamOut::Codec;

constexpr Size kBars{320, 96};
constexpr double kBars_hz = 25;

/// EBU colour bars at 75 %, and what a key and depths may be.
Rgb8 bar(int x) {
  constexpr std::array<Rgb8, 8> kColors{{{191, 191, 191},
                                         {191, 191, 0},
                                         {0, 191, 191},
                                         {0, 191, 0},
                                         {191, 0, 191},
                                         {191, 0, 0},
                                         {0, 0, 191},
                                         {0, 0, 0}}};
  return kColors[static_cast<std::size_t>(x * 8 / kBars.width)];
}
std::uint8_t key_at(int x, int y) { return static_cast<std::uint8_t>(7 * x + 3 * y); }
std::uint16_t depth_mm(int x, int y) { return static_cast<std::uint16_t>(x * 211 + y * 17); }

CompositePtr bars_frame(int number) {
  auto capture = std::make_shared<capture::Capture>();
  capture->number = number;
  capture->mid_exposure = HostTime(std::chrono::milliseconds(1000 + 40 * number));
  auto composite = std::make_shared<Composite>();
  composite->capture = capture;
  composite->view = {kBars, 300, 300, 159.5, 47.5};
  auto& images = composite->images;
  images.color.reset(kBars), images.matte.reset(kBars), images.mixed_depth_m.reset(kBars);
  for (const auto [x, y] : test::each_pixel(kBars)) {
    images.color.at(x, y) = bar(x), images.matte.at(x, y) = key_at(x, y);
    images.mixed_depth_m.at(x, y) = 1e-3F * static_cast<float>(depth_mm(x, y));
  }
  return composite;
}

bool has_program(const char* name) {
  return std::system((std::string("command -v ") + name + " >/dev/null 2>&1").c_str()) == 0;
}

class StreamSinkTest : public ::testing::Test {
 protected:
  std::unique_ptr<StreamSink> sink_of(const std::string& uri, Picture picture,
                                      Codec codec = Codec::kAuto) {
    scene::StreamOut out;
    out.uri = uri, out.picture = picture, out.codec = codec;
    auto sink = StreamSink::create(out, kBars, kBars_hz, false, {}, day_at_zero_);
    EXPECT_TRUE(sink) << sink.error().context;
    return sink ? *std::move(sink) : nullptr;
  }
  /// Decodes all frames of a file with ffmpeg, as raw bytes.
  std::string decoded(const std::string& file, const char* format) {
    const std::string raw = folder_ / "raw";
    test::ChildProcess ffmpeg(
        {"ffmpeg", "-y", "-i", file, "-f", "rawvideo", "-pix_fmt", format, raw}, 120);
    EXPECT_EQ(ffmpeg.wait(), 0);
    return test::read_bytes(raw);
  }
  void write_file(const std::string& file, Picture picture) {
    const auto sink = sink_of(file, picture);
    ASSERT_TRUE(sink);
    for (int i = 1; i <= 10; ++i) ASSERT_TRUE(sink->write(bars_frame(i)));
    const auto done = sink->finish();
    ASSERT_TRUE(done) << done.error().context;
    EXPECT_EQ(sink->report().frames, 10U);
    EXPECT_EQ(sink->report().dropped, 0U);
  }
  /// Sends frames until the receiver ends; their number is bounded by the test's limit.
  void send_to(StreamSink& sink, test::ChildProcess& receiver) {
    int number = 0;
    std::optional<int> ended;
    std::thread waits([&] { ended = receiver.wait(), gone_ = true; });
    EXPECT_TRUE(test::comes_true([&] {
      EXPECT_TRUE(sink.write(bars_frame(++number)));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      return gone_.load();
    }));
    waits.join();
    EXPECT_EQ(ended, 0);
  }
  /// Greatest difference of RGB to the bars, away from their edges.
  static int worst_of_bars(const std::string& rgb, std::size_t frame) {
    int worst = 0;
    const std::size_t at = frame * 3 * static_cast<std::size_t>(kBars.area());
    for (const auto [x, y] : test::each_pixel({0, 8}, {kBars.width, kBars.height - 8})) {
      if (x % 40 < 8 || x % 40 > 31) continue;
      const std::size_t i = at + 3 * static_cast<std::size_t>(y * kBars.width + x);
      const Rgb8 c = bar(x);
      for (const auto& [k, v] : {std::pair{0, c.r}, {1, c.g}, {2, c.b}})
        worst = std::max(worst, std::abs(static_cast<std::uint8_t>(rgb[i + k]) - v));
    }
    return worst;
  }
  static std::string any_port() {
    const std::string address = test::UdpListener().address();
    return address.substr(address.find(':') + 1);
  }

  test::TemporaryFolder folder_;
  DayAtZero day_at_zero_;
  std::atomic<bool> gone_ = false;
};

/// Reads the time codes with ffprobe; the third picture was lost. The first is exposed 1.04 s after
/// host time 0.
TEST_F(StreamSinkTest, TimecodeIsThatOfMidExposure) {
  if (!has_program("ffprobe")) GTEST_SKIP() << "ffprobe is not installed";
  const auto probed = [&](const std::string& file, const char* entries) {
    const std::string text = folder_ / "probed";
    test::ChildProcess ffprobe(
        {"ffprobe", "-v", "error", "-show_entries", entries, "-of", "csv=p=0", file}, 120, text);
    EXPECT_EQ(ffprobe.wait(), 0);
    return test::read_bytes(text);
  };
  const auto write = [&](const std::string& file, Codec codec) {
    const auto sink = sink_of(file, Picture::kFill, codec);
    ASSERT_TRUE(sink);
    for (const int i : {1, 2, 4}) ASSERT_TRUE(sink->write(bars_frame(i)));
    ASSERT_TRUE(sink->finish());
  };
  day_at_zero_ = [](HostTime) { return std::chrono::seconds(12 * 3600 + 59 * 60 + 58); };
  write(folder_ / "fill.mov", Codec::kAuto);
  EXPECT_NE(probed(folder_ / "fill.mov", "stream_tags=timecode").find("12:59:59:01"),
            std::string::npos);
  write(folder_ / "fill.mkv", Codec::kH264);
  const std::string frames = probed(folder_ / "fill.mkv", "frame_tags=timecode");
  for (const char* code : {"12:59:59:01", "12:59:59:02", "12:59:59:04"})
    EXPECT_NE(frames.find(code), std::string::npos) << code << " in " << frames;
  EXPECT_EQ(frames.find("12:59:59:03"), std::string::npos);
  day_at_zero_ = nullptr;
  write(folder_ / "by_host.mkv", Codec::kH264);
  EXPECT_NE(probed(folder_ / "by_host.mkv", "frame_tags=timecode").find("00:00:00:03"),
            std::string::npos);
}

TEST_F(StreamSinkTest, AFileKeepsColourAlphaAndDepthExactly) {
  if (!has_program("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const std::size_t area = static_cast<std::size_t>(kBars.area());
  write_file(folder_ / "fill.mkv", Picture::kFill);
  EXPECT_EQ(worst_of_bars(decoded(folder_ / "fill.mkv", "rgb24"), 9), 0);

  write_file(folder_ / "alpha.mkv", Picture::kAlpha);
  const std::string bgra = decoded(folder_ / "alpha.mkv", "bgra");
  ASSERT_EQ(bgra.size(), 10 * 4 * area);
  write_file(folder_ / "depth.mkv", Picture::kDepth);
  const std::string gray = decoded(folder_ / "depth.mkv", "gray16le");
  ASSERT_EQ(gray.size(), 10 * 2 * area);
  int wrong_alpha = 0, wrong_depth = 0;
  for (const auto [x, y] : test::each_pixel(kBars)) {
    const std::size_t i = 9 * area + static_cast<std::size_t>(y * kBars.width + x);
    wrong_alpha += static_cast<std::uint8_t>(bgra[4 * i + 3]) != key_at(x, y) ||
                   static_cast<std::uint8_t>(bgra[4 * i]) != bar(x).b;
    const unsigned low = static_cast<std::uint8_t>(gray[2 * i]),
                   high = static_cast<std::uint8_t>(gray[2 * i + 1]);
    wrong_depth += (low | high << 8) != depth_mm(x, y);
  }
  EXPECT_EQ(wrong_alpha, 0);
  EXPECT_EQ(wrong_depth, 0);
}

TEST_F(StreamSinkTest, AnMp4HasEveryPictureInItsColours) {
  if (!has_program("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  write_file(folder_ / "fill.mp4", Picture::kFill);
  const std::string rgb = decoded(folder_ / "fill.mp4", "rgb24");
  ASSERT_EQ(rgb.size(), 10U * 3 * static_cast<std::size_t>(kBars.area()));
  EXPECT_LE(worst_of_bars(rgb, 9), 4);
}

TEST_F(StreamSinkTest, AProResFileHasTheAlpha) {
  if (!has_program("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  write_file(folder_ / "alpha.mov", Picture::kAlpha);
  const std::string rgba = decoded(folder_ / "alpha.mov", "rgba");
  ASSERT_EQ(rgba.size(), 10U * 4 * static_cast<std::size_t>(kBars.area()));
  int worst = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBars.area()); ++i)
    worst = std::max(worst, std::abs(static_cast<std::uint8_t>(rgba[4 * i + 3]) -
                                     key_at(static_cast<int>(i) % kBars.width,
                                            static_cast<int>(i) / kBars.width)));
  EXPECT_LE(worst, 2);
}

TEST_F(StreamSinkTest, TimeStampsAreThoseOfMidExposure) {
  if (!has_program("ffprobe")) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string file = folder_ / "fill.mkv";
  const auto sink = sink_of(file, Picture::kFill);
  ASSERT_TRUE(sink);
  for (const int number : {1, 2, 3, 7, 8}) ASSERT_TRUE(sink->write(bars_frame(number)));
  ASSERT_TRUE(sink->finish());
  test::ChildProcess probe({"ffprobe", "-v", "error", "-show_entries",
                            "packet=pts_time:stream=width,height,r_frame_rate", "-of", "csv", file},
                           60, folder_ / "times");
  EXPECT_EQ(probe.wait(), 0);
  const std::string said = test::read_bytes(folder_ / "times");
  for (const char* line : {"packet,0.000000\n", "packet,0.040000\n", "packet,0.080000\n",
                           "packet,0.240000\n", "packet,0.280000\n", "stream,320,96,25/1\n"})
    EXPECT_NE(said.find(line), std::string::npos) << line << said;
}

TEST_F(StreamSinkTest, FfmpegReceivesSrtAndRtp) {
  if (!has_program("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  for (const char* scheme : {"srt", "rtp"}) {
    const std::string address = std::string(scheme) + "://127.0.0.1:" + any_port();
    const std::string raw = folder_ / scheme;
    const std::string from = address + (scheme[0] == 's' ? "?mode=listener" : "");
    gone_ = false;
    test::ChildProcess ffmpeg(
        {"ffmpeg", "-y", "-v", "error", "-i", from, "-frames:v", "5", "-sws_flags",
         "accurate_rnd+full_chroma_int", "-f", "rawvideo", "-pix_fmt", "rgb24", raw},
        100, folder_ / "log");
    const auto sink = sink_of(address, Picture::kFill);
    ASSERT_TRUE(sink);
    send_to(*sink, ffmpeg);
    const std::string rgb = test::read_bytes(raw);
    ASSERT_EQ(rgb.size(), 5U * 3 * static_cast<std::size_t>(kBars.area()))
        << scheme << test::read_bytes(folder_ / "log");
    EXPECT_LE(worst_of_bars(rgb, 4), 2) << scheme;
    const std::string said = test::read_bytes(folder_ / "log");
    EXPECT_EQ(said.find("SEI"), std::string::npos) << said << ": the messages are not as they must";
  }
}

/// Sends what is written to stderr to a file while it lives.
class ErrorsTo {
 public:
  explicit ErrorsTo(const std::string& path) : before_(::dup(STDERR_FILENO)) {
    const int file = ::open(path.c_str(), O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0600);
    ::dup2(file, STDERR_FILENO);
    ::close(file);
  }
  ~ErrorsTo() {
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
  }
  ErrorsTo(const ErrorsTo&) = delete;
  ErrorsTo& operator=(const ErrorsTo&) = delete;

 private:
  const int before_;
};

/// The rig boots before the mixer.
TEST_F(StreamSinkTest, CallsAReceiverUntilItListens) {
  if (!has_program("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string address = "srt://127.0.0.1:" + any_port();
  const auto sink = sink_of(address, Picture::kFill);
  ASSERT_TRUE(sink);
  const ErrorsTo log(folder_ / "said");
  int number = 0;
  EXPECT_TRUE(test::comes_true([&] {
    EXPECT_TRUE(sink->write(bars_frame(++number)));
    std::this_thread::yield();
    return test::read_bytes(folder_ / "said").find("nobody listens there") != std::string::npos;
  }));
  test::ChildProcess ffmpeg({"ffmpeg", "-y", "-v", "error", "-i", address + "?mode=listener",
                             "-frames:v", "5", "-f", "null", "-"},
                            100, folder_ / "log");
  send_to(*sink, ffmpeg);
  const std::string said = test::read_bytes(folder_ / "said");
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST_F(StreamSinkTest, AHostThatIsNotKnownIsRefusedBeforeTheRun) {
  scene::StreamOut out;
  for (const char* uri : {"rtp://mixer.invalid:5004", "rtp://127.0.0.1 :5004", "rtp://-:5004",
                          "srt://mixer.invalid:7001", "rtp://300.0.0.1:5004"}) {
    out.uri = uri;
    EXPECT_TRUE(test::refused(StreamSink::check(out, kBars, kBars_hz), {uri, "is not known"},
                              ErrorCode::kUsage))
        << uri;
  }
  for (const char* uri : {"rtp://localhost:5004", "rtp://127.0.0.1:5004",
                          "srt://:7001?mode=listener", "srt://[::1]:7001"}) {
    out.uri = uri;
    EXPECT_TRUE(StreamSink::check(out, kBars, kBars_hz)) << uri;
  }
}

TEST_F(StreamSinkTest, GStreamerReceivesSharedMemory) {
  if (!has_program("gst-launch-1.0")) GTEST_SKIP() << "gstreamer1.0-tools is not installed";
  const std::string socket = folder_ / "depth", raw = folder_ / "raw";
  const auto sink = sink_of("shm://" + socket, Picture::kDepth);
  ASSERT_TRUE(sink);
  ASSERT_TRUE(sink->write(bars_frame(1)));
  test::ChildProcess reader(
      {"gst-launch-1.0", "-q", "shmsrc", "socket-path=" + socket, "num-buffers=4", "!",
       "video/x-raw,format=GRAY16_LE,width=320,height=96,framerate=25/1", "!", "filesink",
       "location=" + raw},
      100, folder_ / "log");
  send_to(*sink, reader);
  const std::string gray = test::read_bytes(raw);
  ASSERT_EQ(gray.size(), 4U * 2 * static_cast<std::size_t>(kBars.area()))
      << test::read_bytes(folder_ / "log");
  int wrong = 0;
  for (const auto [x, y] : test::each_pixel(kBars)) {
    const std::size_t i = 2 * static_cast<std::size_t>(y * kBars.width + x);
    const unsigned low = static_cast<std::uint8_t>(gray[i]),
                   high = static_cast<std::uint8_t>(gray[i + 1]);
    wrong += (low | high << 8) != depth_mm(x, y);
  }
  EXPECT_EQ(wrong, 0);
}

TEST_F(StreamSinkTest, AReceiverThatIsNotThereOrTakesNothingCostsPicturesAlone) {
  const auto sink = sink_of("srt://127.0.0.1:" + any_port(), Picture::kFillKey);
  ASSERT_TRUE(sink);
  for (int i = 1; i <= 100; ++i) ASSERT_TRUE(sink->write(bars_frame(i)));
  ASSERT_TRUE(sink->finish());
  EXPECT_EQ(sink->report().frames + sink->report().dropped, 100U);
}

/// A service that starts again after a fault writes the same name.
TEST_F(StreamSinkTest, AFileThatHoldsAShowStays) {
  const std::string show = folder_ / "show.mkv";
  std::ofstream(show).close();  // an empty file holds nothing
  std::string first;
  for (const char* name : {"show.mkv", "show-2.mkv", "show-3.mkv"}) {
    const auto sink = sink_of(show, Picture::kFill);
    ASSERT_TRUE(sink);
    EXPECT_EQ(sink->report().uri, folder_ / name);
    ASSERT_TRUE(sink->write(bars_frame(1)));
    ASSERT_TRUE(sink->finish());
    EXPECT_GT(std::filesystem::file_size(folder_ / name), 0U);
    if (first.empty()) first = test::read_bytes(show);
  }
  EXPECT_EQ(test::read_bytes(show), first);
}

TEST_F(StreamSinkTest, AFileThatCannotBeWrittenIsOneLine) {
  scene::StreamOut out;
  out.uri = "/nowhere/at/all.mkv";
  const auto sink = StreamSink::create(out, kBars, kBars_hz, false, {});
  bool failed = !sink;
  for (int i = 1; !failed && i <= 10; ++i) failed = !(*sink)->write(bars_frame(i));
  if (!failed) failed = !(*sink)->finish();
  EXPECT_TRUE(failed);
}

}  // namespace
}  // namespace mixrig::output
