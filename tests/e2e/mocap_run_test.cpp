// SPDX-License-Identifier: Apache-2.0
// A composite driven by NatNet over the loopback interface: the socket is real, the time is
// injected. The studio's take is the rig; its motion capture is sent with delay, jitter, loss and
// faults.
#include <cmath>
#include <fstream>
#include <map>
#include <random>
#include <regex>

#include <gtest/gtest.h>

#include "host/run/loop/run.h"
#include "host/run/session/session.h"
#include "tests/e2e/command.h"
#include "tests/e2e/composited.h"
#include "tests/support/natnet_sender.h"
#include "tests/support/progress.h"
#include "tests/support/taken_mocap.h"
#include "tests/support/threaded_clock.h"

namespace mixrig::test {
namespace {

namespace fs = std::filesystem;
using capture::PoseLoss;

constexpr double kHost_s = 500;  ///< host time of the take's first frame
constexpr int kBody = 7;
// The system's noise is 0.2 mm and 0.02 deg per axis, 0.35 mm and 0.035 deg in all; the jitter
// leaves its clock uncertain by 0.2 ms, in which the hand moves by less than 0.1 mm.
constexpr double kNoise_mm = 0.45, kNoise_deg = 0.05;

HostTime host(double take_s) { return HostTime(Duration(std::llround((kHost_s + take_s) * 1e9))); }

/// Delay and faults of the stream.
struct Stream {
  double delay_s = 0.03, jitter_s = 0.002;
  double given_delay_s = 0.03;           ///< delay that the scene states
  double latency_s = 0.06;               ///< from mid-exposure until the frame is composited
  double stop_s = 1e9;                   ///< the sender falls silent at this time of the take
  double step_from_s = 1e9, step_s = 0;  ///< clock step: time in the take, size
  bool renumbered = false;               ///< the frame numbers start again at the clock step
  int body = kBody;
  bool second_sender = false;  ///< another sender repeats the first sample
};

/// Plays the take as live devices: before it gives out a frame, time advances to the compositing
/// of that frame, and every packet that arrives until then is received at its own time.
class StreamedTake final : public capture::CaptureSource {
 public:
  StreamedTake(std::unique_ptr<capture::CaptureSource> take, std::vector<TakenSample> samples,
               Stream stream, NatNetSender& sender, ThreadedClock& clock, session::Session& session)
      : take_(std::move(take)),
        samples_(std::move(samples)),
        stream_(stream),
        sender_(sender),
        clock_(clock),
        session_(session),
        info_(take_->info()) {
    info_.frames = capture::kEndless;
    info_.has_truth = false;  // live devices have none, but their true poses are known
  }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override {
    if (number > take_->info().frames) return false;
    EXPECT_TRUE(number == 1 || composited_->wait_for(number - 1)) << number;
    MIXRIG_ASSIGN(const bool there, take_->read(number, capture));
    const double due_s = capture.time_s + stream_.latency_s;
    while (next_ < samples_.size() && arrival_s() <= due_s) deliver();
    clock_.sleep_until(host(due_s));
    capture.mid_exposure = host(capture.time_s);
    return there;
  }
  Result<void> read_truth(int, capture::Truth&) override {
    return Error{ErrorCode::kData, "no truth"};
  }
  void set_sink(Composited* composited) { composited_ = composited; }
  int sent() const { return sent_; }

 private:
  double arrival_s() const { return samples_[next_].time_s + stream_.delay_s + jitter_s_; }
  void deliver() {
    TakenSample sample = samples_[next_];
    clock_.sleep_until(host(arrival_s()));
    ++next_;
    jitter_s_ = stream_.jitter_s * share_(random_);
    if (sample.time_s > stream_.stop_s) return;
    if (sample.time_s > stream_.step_from_s) {
      sample.stamp_s += stream_.step_s;
      if (stream_.renumbered) sample.number -= samples_[0].number;
    }
    EXPECT_TRUE(comes_true([&] { return sender_.has_client(0); }));
    sender_.send(packet_of(sample, stream_.body));
    if (stream_.second_sender) sender_.send_from_elsewhere(packet_of(samples_[0], stream_.body));
    ++sent_;
    EXPECT_TRUE(comes_true([&] { return heard() >= static_cast<std::uint64_t>(sent_); })) << sent_;
  }
  /// Number of packets that the receiver has handled, without those of the second sender.
  std::uint64_t heard() const {
    return session_.poses->stream()->packets + session_.poses->faults().packets_late;
  }

  std::unique_ptr<capture::CaptureSource> take_;
  const std::vector<TakenSample> samples_;
  const Stream stream_;
  NatNetSender& sender_;
  ThreadedClock& clock_;
  session::Session& session_;
  capture::SourceInfo info_;
  Composited* composited_ = nullptr;
  std::size_t next_ = 0;
  int sent_ = 0;
  double jitter_s_ = 0;
  std::mt19937 random_{11};
  std::uniform_real_distribution<double> share_{0, 1};
};

/// All tests share one take of a hand-held camera.
class MocapRun : public CommandTest {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-mocap-XXXXXX").string();
    take_ = mkdtemp(pattern.data());
    const std::string command = std::string(MIXRIG_COMMAND) + " ", quiet = " >/dev/null 2>&1";
    const fs::path take = take_ / "take";
    ASSERT_EQ(
        std::system(
            (MIXRIG_STUDIO_TAKE " " + command + take.string() +
             " --plain --scenario handheld --rig sr3000 --seed 31 --frames 40 --size 64x48" + quiet)
                .c_str()),
        0);
    ASSERT_EQ(std::system((command + "scan --take " + take.string() + " --frames 1-6 " +
                           (take / "room").string() + quiet)
                              .c_str()),
              0);
    std::ifstream in(take / "scene.toml");
    const std::string text(std::istreambuf_iterator<char>(in), {});
    std::ofstream(take / "scene.toml")
        << "calibration = \"truth/calibration.toml\"\n"
        << std::regex_replace(text, std::regex("learn = .*"), "model = \"room\"");
  }
  static void TearDownTestSuite() { fs::remove_all(take_); }

  Result<session::RunReport> run_with(const Stream& stream) {
    const fs::path take = take_ / "take";
    session::SessionOptions options;
    options.scene = take / "scene.toml";
    options.source = "take:" + take.string();
    options.backend = {render::Backend::kCpu, 2};
    MIXRIG_ASSIGN(const auto session, session::open_session(options));
    NatNetSender sender;
    ThreadedClock clock;
    clock.sleep_until(host(-5));
    session->scene.pose_source = scene::PoseSource::kMocap;
    session->scene.camera.mocap = {
        "127.0.0.1:" + std::to_string(sender.port()), {}, kBody, false, stream.given_delay_s};
    session->scene.camera.when_lost = scene::WhenLost::kHide;
    session->poses.reset();
    auto source = std::make_unique<StreamedTake>(std::move(session->source), read_taken_mocap(take),
                                                 stream, sender, clock, *session);
    poses_.clear();
    StreamedTake* const streamed = source.get();
    session->source = std::move(source);
    session::RunParts parts;
    auto sink = std::make_unique<Composited>(poses_);
    streamed->set_sink(sink.get());
    parts.sinks.push_back(std::move(sink));
    auto report = session::run(*session, {}, clock, {}, std::move(parts));
    sent_ = streamed->sent();
    return report;
  }
  static std::uint64_t lost(const session::RunReport& report, PoseLoss why) {
    return report.pose.frames.frames[static_cast<std::size_t>(why)];
  }
  static double value(const session::RunReport& report, const char* what, const char* which) {
    return report.pose.error->to_json().at(what).at(which);
  }

  void follows_the_hand();
  void predicts_what_has_not_come();
  void needs_the_delay();
  void loses_a_sender_that_stops();
  void survives_a_clock_that_steps();
  void refuses_another_body();
  void hears_one_sender();

  static fs::path take_;
  std::map<int, capture::CameraPose> poses_;
  int sent_ = 0;
};
fs::path MocapRun::take_;

void MocapRun::follows_the_hand() {
  const auto report = run_with({});
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->frames.frame_ms.count(), 40U);
  EXPECT_EQ(report->pose.frames.lost(), 0U);
  EXPECT_LT(value(*report, "shift_mm", "rms"), kNoise_mm);
  EXPECT_LT(value(*report, "turn_deg", "rms"), kNoise_deg);
  const auto pose = session::to_json(*report)["pose"];
  EXPECT_EQ(pose["source"], "mocap");
  EXPECT_EQ(pose["stream"]["packets"], sent_);
  EXPECT_EQ(pose["stream"]["delay_ms"], 30.0);
  // The studio loses 2 % of about 310 samples.
  EXPECT_GT(pose["stream"]["lost_pct"], 0.5);
  EXPECT_LT(pose["stream"]["lost_pct"], 5.5);
  EXPECT_EQ(pose["stream"]["clock_steps"], 0);
  EXPECT_LE(pose["age_ms"]["p95"], 1.5e3 / 120);
  std::printf("interpolated: %s\n", report->pose.error->to_line().c_str());
}

void MocapRun::predicts_what_has_not_come() {
  Stream early;
  early.latency_s = 0.012;
  const auto predicts = run_with(early);
  ASSERT_TRUE(predicts) << predicts.error().context;
  EXPECT_EQ(predicts->pose.frames.lost(), 0U);
  // About 24 ms after the newest sample, the noise of the two poses, 30 ms apart, has grown to
  // sqrt(1.8^2 + 0.8^2) = 2 times that of one pose, 0.35 mm; where a sample is lost, it is older.
  EXPECT_GT(value(*predicts, "shift_mm", "rms"), kNoise_mm);
  EXPECT_LT(value(*predicts, "shift_mm", "rms"), 1.5);
  EXPECT_GT(session::to_json(*predicts)["pose"]["age_ms"]["p50"], 15.0);
  std::printf("predicted: %s\n", predicts->pose.error->to_line().c_str());
}

void MocapRun::needs_the_delay() {
  Stream stream;
  stream.given_delay_s = 0;
  const auto wrong = run_with(stream);
  ASSERT_TRUE(wrong) << wrong.error().context;
  // With a delay of zero the camera appears where it was 30 ms before.
  double sum_mm2 = 0;
  int pairs = 0;
  const auto samples = read_taken_mocap(take_ / "take");
  for (std::size_t i = 60; i + 64 < samples.size(); ++i, ++pairs)
    for (int axis = 0; axis < 3; ++axis)
      sum_mm2 += std::pow(1e3 * (samples[i].position_m[axis] - samples[i - 4].position_m[axis]), 2);
  const double moved_mm = std::sqrt(sum_mm2 / pairs);
  EXPECT_GT(value(*wrong, "shift_mm", "rms"), kNoise_mm);
  EXPECT_NEAR(value(*wrong, "shift_mm", "rms"), moved_mm, 0.5 * moved_mm);
}

void MocapRun::loses_a_sender_that_stops() {
  Stream stream;
  stream.stop_s = 0.9;
  const auto report = run_with(stream);
  ASSERT_TRUE(report) << report.error().context;
  for (const auto& [number, pose] : poses_) {
    const double t_s = (number - 1) / 25.0;
    if (t_s < 0.98) {
      EXPECT_TRUE(pose.ok()) << t_s;
    }
    if (t_s > 1.02) {
      EXPECT_EQ(pose.loss, PoseLoss::kTooOld) << t_s;
    }
  }
  EXPECT_GE(lost(*report, PoseLoss::kTooOld), 14U);
  EXPECT_EQ(session::to_json(*report)["pose"]["lost_by"]["too_old"],
            lost(*report, PoseLoss::kTooOld));
}

void MocapRun::survives_a_clock_that_steps() {
  for (const double step_s : {3600.0, -3600.0, -0.4}) {
    Stream stream;
    stream.step_from_s = 0.8;
    stream.step_s = step_s;
    stream.renumbered = step_s < -1;  // a server that was started again
    const auto report = run_with(stream);
    ASSERT_TRUE(report) << report.error().context;
    EXPECT_EQ(report->pose.faults.clock_steps, 1U) << step_s;
    EXPECT_LE(report->pose.frames.lost(), 3U) << step_s;
    EXPECT_LT(value(*report, "shift_mm", "max"), 5) << step_s;
    EXPECT_LT(session::to_json(*report)["pose"]["stream"]["lost_pct"], 5.5) << "a restart";
  }
}

void MocapRun::refuses_another_body() {
  Stream stream;
  stream.body = kBody + 1;
  const auto report = run_with(stream);
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->pose.faults.refused, static_cast<std::uint64_t>(sent_));
  EXPECT_EQ(lost(*report, PoseLoss::kNoSample), 40U);
  EXPECT_NE(session::to_table(*report).find("in which the camera's body is missing or not tracked"),
            std::string::npos);
}

void MocapRun::hears_one_sender() {
  Stream stream;
  stream.second_sender = true;
  const auto report = run_with(stream);
  ASSERT_TRUE(report) << report.error().context;
  // The run may end before the last bad packet was read.
  EXPECT_GE(report->pose.faults.packets_foreign, static_cast<std::uint64_t>(sent_) - 1);
  EXPECT_EQ(report->pose.frames.lost(), 0U);
  EXPECT_LT(value(*report, "shift_mm", "rms"), kNoise_mm);
}

// One test for all cases, because they share the rendered take.
TEST_F(MocapRun, DrivesACompositeAndEachFaultOfItsStreamIsAnEvent) {
  follows_the_hand();
  predicts_what_has_not_come();
  needs_the_delay();
  loses_a_sender_that_stops();
  survives_a_clock_that_steps();
  refuses_another_body();
  hears_one_sender();
}

}  // namespace
}  // namespace mixrig::test
