// SPDX-License-Identifier: Apache-2.0
#include "host/app/run.h"

#include <algorithm>

#include "hal/base/log.h"
#include "host/app/contact_sheet.h"
#include "host/app/judge.h"
#include "host/app/output_folder.h"
#include "host/image_io/image_io.h"

namespace mixrig::app {
namespace {

constexpr const char* kReportName = "report.json";
constexpr int kSheetStep = 10;              // row k of an endless sheet: frame first + 10 k^2
constexpr std::size_t kReserved = 100'000;  // frames: an hour of 25 Hz without growing

Result<FrameRange> range_of(const Session& session, const RunOptions& options) {
  const FrameRange range = options.frames.value_or(session.default_frames());
  const int frames = session.source->info().frames;
  const std::string has = "the take has frames 1-" + std::to_string(frames);
  if (!options.frames && range.first > range.second)
    return Error{ErrorCode::kUsage, has +
                                        " and the background is learned from all of them: none "
                                        "is left to composite, name some by --frames"};
  if (range.first < 1 || range.second < range.first || range.second > frames)
    return Error{ErrorCode::kUsage, "--frames " + std::to_string(range.first) + "-" +
                                        std::to_string(range.second) + " is out of range: " + has};
  return range;
}

double foreground_pct(const Image<std::uint8_t>& matte) {
  std::size_t count = 0;
  for (int y = 0; y < matte.height(); ++y)
    count += static_cast<std::size_t>(std::count_if(matte.row(y), matte.row(y) + matte.width(),
                                                    [](std::uint8_t m) { return m >= 128; }));
  return 100.0 * static_cast<double>(count) / static_cast<double>(matte.size().area());
}

bool moved(const geometry::Pose& a, const geometry::Pose& b) {
  constexpr double kStill_m = 0.01, kStill_rad = 0.004;
  return (a.translation_m - b.translation_m).norm() > kStill_m ||
         a.rotation.angularDistance(b.rotation) > kStill_rad;
}

/// What lives as long as a run; one method a step of the frame loop.
class Runner {
 public:
  Runner(Session& session, const RunOptions& options, const Clock& clock)
      : session_(session), options_(options), clock_(clock), sheet_(title()) {}

  Result<void> prepare(FrameRange range, const ProgressFn& progress);
  /// False when the source has ended.
  Result<bool> frame(int number);
  Result<RunReport> finish(std::string ended);

 private:
  std::string title() const {
    return session_.scene.path.filename().string() + " in " + session_.source->info().name;
  }
  bool judges() const { return options_.judge && session_.source->info().has_truth; }
  Result<void> compose(const render::FrameInput& input);
  Result<void> look(int number, const render::FrameInput& input);
  std::vector<int> sheet_frames(FrameRange range) const;
  Result<void> add_last_to_sheet();
  void watch_camera(const geometry::Pose& world_from_target);

  Session& session_;
  const RunOptions& options_;
  const Clock& clock_;
  std::unique_ptr<render::Compositor> compositor_;
  std::optional<OutputFolder> folder_;
  std::optional<RunWriter> writer_;
  std::vector<int> sheet_frames_;
  ContactSheet sheet_;
  Judge judge_;
  take::TakeFrame frame_;
  render::FrameOutput output_;
  std::optional<geometry::Pose> first_pose_;
  bool warned_ = false;
  RunReport report_;
};

Result<void> Runner::prepare(FrameRange range, const ProgressFn& progress) {
  if (options_.out) {
    MIXRIG_ASSIGN(folder_, OutputFolder::create(*options_.out, kReportName));
    MIXRIG_ASSIGN(writer_, RunWriter::create(folder_->staging(), session_.source->info(),
                                             session_.setup.view, options_.output));
    sheet_frames_ = sheet_frames(range);
  }
  MIXRIG_TRY(prepare_background(session_, progress));
  MIXRIG_ASSIGN(compositor_, make_compositor(session_.setup, session_.backend));
  report_.backend = backend_of(*compositor_);
  report_.renderer = compositor_->renderer();
  report_.size = session_.setup.view.size_px;
  const auto frames = std::min(kReserved, static_cast<std::size_t>(range.second - range.first) + 1);
  report_.frame_ms.reserve(frames);
  report_.foreground_pct.reserve(frames);
  for (auto& times : report_.stage_ms) times.reserve(frames);
  return {};
}

/// Spread over the range; ever farther apart where nobody knows its end.
std::vector<int> Runner::sheet_frames(FrameRange range) const {
  if (range.second != kEndless) return spread(range.first, range.second, options_.sheet_rows);
  std::vector<int> frames;
  for (int k = 0; k < options_.sheet_rows; ++k) frames.push_back(range.first + kSheetStep * k * k);
  return frames;
}

/// A run that was stopped before the first of its sheet's frames shows the last one that it had.
Result<void> Runner::add_last_to_sheet() {
  output_.inspect = true;
  MIXRIG_TRY(compositor_->compose(
      {frame_.color, frame_.depth_m, session_.world_from_target(frame_)}, output_));
  sheet_.add_row(frame_.number, frame_.color, output_, judge_.truth().composite);
  return {};
}

Result<bool> Runner::frame(int number) {
  MIXRIG_ASSIGN(const bool there, session_.source->read(number, frame_));
  if (!there) return false;
  const geometry::Pose world_from_target = session_.world_from_target(frame_);
  watch_camera(world_from_target);
  const render::FrameInput input{frame_.color, frame_.depth_m, world_from_target};
  MIXRIG_TRY(compose(input));
  report_.foreground_pct.push_back(foreground_pct(output_.matte));
  MIXRIG_TRY(look(number, input));
  if (writer_) MIXRIG_TRY(writer_->write(frame_, world_from_target, output_));
  return true;
}

Result<void> Runner::compose(const render::FrameInput& input) {
  output_.inspect = false;
  const HostTime begin = clock_.now();
  MIXRIG_TRY(compositor_->compose(input, output_));
  report_.frame_ms.push_back(static_cast<float>(milliseconds(clock_.now() - begin)));
  const render::StageTimes& times = compositor_->stage_times();
  for (std::size_t i = 0; i < times.size(); ++i) report_.stage_ms[i].push_back(times[i]);
  return {};
}

/// Inspection images cost time that a live frame does not spend: a second, untimed pass.
Result<void> Runner::look(int number, const render::FrameInput& input) {
  const bool on_sheet =
      std::find(sheet_frames_.begin(), sheet_frames_.end(), number) != sheet_frames_.end();
  if (!on_sheet && !judges() && !options_.output.inspect) return {};
  output_.inspect = true;
  MIXRIG_TRY(compositor_->compose(input, output_));
  if (judges()) MIXRIG_TRY(judge_.add(*session_.source, number, output_));
  if (on_sheet) sheet_.add_row(number, frame_.color, output_, judge_.truth().composite);
  return {};
}

void Runner::watch_camera(const geometry::Pose& world_from_target) {
  if (!first_pose_) first_pose_ = world_from_target;
  if (warned_ || !session_.background || !moved(*first_pose_, world_from_target)) return;
  warned_ = true;
  log_warning("app",
              "the camera moves, the background is of a static camera: people are keyed "
              "wrongly away from the first pose");
}

Result<RunReport> Runner::finish(std::string ended) {
  if (report_.frame_ms.empty())
    return Error{ErrorCode::kData, "no frame was composited (" + ended + "): nothing was written"};
  report_.ended = std::move(ended);
  report_.live = session_.source->report();
  if (judges()) report_.error = judge_.errors();
  report_.rss_mb = peak_rss_mb();
  if (!folder_) return std::move(report_);
  MIXRIG_TRY(writer_->finish());
  if (sheet_.empty()) MIXRIG_TRY(add_last_to_sheet());
  MIXRIG_TRY(image_io::write_png(folder_->staging() / "contact_sheet.png", sheet_.draw().view()));
  MIXRIG_TRY(write_text(folder_->staging() / kReportName, to_json(report_).dump(2) + "\n"));
  MIXRIG_TRY(folder_->finish());
  return std::move(report_);
}

}  // namespace

Result<RunReport> run(Session& session, const RunOptions& options, const Clock& clock,
                      const ProgressFn& progress) {
  MIXRIG_ASSIGN(const FrameRange range, range_of(session, options));
  Runner runner(session, options, clock);
  MIXRIG_TRY(runner.prepare(range, progress));
  const auto stopped = [&] { return options.stop != nullptr && *options.stop; };
  for (int number = range.first; !stopped(); ++number) {
    MIXRIG_ASSIGN(const bool there, runner.frame(number));
    if (!there && !stopped()) return runner.finish("end of the source");
    if (!there) break;
    if (progress && range.second != kEndless)
      progress("frames", number - range.first + 1, range.second - range.first + 1);
    if (number == range.second) return runner.finish("frames");
  }
  return runner.finish("stopped");
}

}  // namespace mixrig::app
