// SPDX-License-Identifier: Apache-2.0
#include "host/output/viewfinder/viewfinder.h"

#include <utility>

#include "hal/base/guarded.h"
#include "host/judge/measure/motion.h"
#include "host/output/viewfinder/rate_meter.h"
#include "host/output/viewfinder/screen.h"
#include "host/output/viewfinder/sync_health.h"
#include "host/output/viewfinder/window.h"

namespace mixrig::viewfinder {
namespace {

constexpr Duration kLook = std::chrono::milliseconds(10);     // for keys
constexpr Duration kRedraw = std::chrono::milliseconds(100);  // while no composite comes
constexpr Duration kAskDevices = std::chrono::milliseconds(500);
constexpr Duration kMessage = std::chrono::seconds(3);

}  // namespace

/// Work of the window's thread.
class Viewfinder::Loop {
 public:
  Loop(Viewfinder& owner, Window& window)
      : owner_(owner),
        window_(window),
        live_(owner.source_.info().is_live()),
        began_(owner.clock_.now()) {
    state_.view = owner.options_.view;
    state_.overlays[static_cast<std::size_t>(Overlay::kHelp)] = owner.options_.help;
    facts_.live = live_, facts_.rate_hz = owner.source_.info().rate_hz;
    last_arrival_ = last_drawn_ = asked_ = began_;
  }

  /// Shows composites until the sink is finished. Errors: those of Window::show.
  Result<void> run() {
    MIXRIG_TRY(draw());
    for (;;) {
      const bool over = owner_.over_;  // read before the queue
      auto handed = owner_.queue_.pop(over ? Duration(0) : kLook);
      if (!handed && over) return {};
      const bool changed = follow_run();
      const bool keys = handle_keys() || changed;
      const HostTime now = owner_.clock_.now();
      if (handed) take(*handed, now);
      if (live_ && now - asked_ >= kAskDevices) ask_devices(now);
      const bool news = handed && !state_.frozen;
      if (!news && !keys && now - last_drawn_ < kRedraw) continue;
      MIXRIG_TRY(draw());
      if (news) count_shown(*handed);
    }
  }

 private:
  bool follow_run();
  bool handle_keys();
  void leave();
  void choose_object();
  void clicked(Window::Click click);
  void obey(Request request);
  void give(const output::RunOrder& order, std::string_view done = {});
  void say(std::string_view words);
  void take(const Handed& handed, HostTime now);
  void ask_devices(HostTime now);
  void find_facts(HostTime now);
  Result<void> draw();
  void count_shown(const Handed& handed);

  Viewfinder& owner_;
  Window& window_;
  const bool live_;
  const HostTime began_;
  Screen screen_;
  ViewState state_;
  ScreenFacts facts_;
  RateMeter rate_;
  Drawn drawn_;                     ///< by screen_
  int placing_ = -1;                ///< object that the next click sets; below 0: none
  bool is_new_ = false;             ///< composite_, since the last picture
  output::CompositePtr composite_;  ///< that is shown
  HostTime last_arrival_{}, last_drawn_{}, asked_{};
  HostTime message_until_{}, leaves_until_{};
  std::optional<HostTime> last_depth_;  ///< mid-exposure of the last capture that had any
  std::optional<capture::SourceReport> devices_;
};

void Viewfinder::Loop::say(std::string_view words) {
  facts_.message.set("{}", words);
  message_until_ = owner_.clock_.now() + kMessage;
}

/// Gives an order to the run; shows `done`, or why the order is refused.
void Viewfinder::Loop::give(const output::RunOrder& order, std::string_view done) {
  const auto given = owner_.orders_.give(order);
  if (!given) return say(given.error().context);
  if (!done.empty()) say(done);
}

void Viewfinder::Loop::obey(Request request) {
  const output::RunState run = owner_.orders_.state();
  switch (request) {
    case Request::kLeave:
      return leave();
    case Request::kQuit:
      return give(output::StopRun{}, "ending");
    case Request::kLearn:
      if (!run.can_learn) return say("this run does not look for changes of the room");
      return give(output::LearnChanges{}, "changes of the room become background");
    case Request::kRecord:
      if (!run.can_record) return say("cannot record: start with --out DIR or --page");
      return give(output::Record{!run.recording}, !run.recording      ? "recording"
                                                  : run.records_takes ? "recording ended"
                                                                      : "recording paused");
    case Request::kPlace:
      return choose_object();
    case Request::kFullScreen:
      return window_.toggle_full_screen();
    case Request::kNone:
      break;
  }
}

/// Leaves full screen. Elsewhere the run ends only by a second press while its message is shown.
void Viewfinder::Loop::leave() {
  if (window_.can_leave_full_screen()) return window_.toggle_full_screen();
  if (owner_.clock_.now() < leaves_until_) return give(output::StopRun{}, "ending");
  say("press Esc again to end the run");
  leaves_until_ = message_until_;
}

/// Chooses the object to place: the next one with each press, none after the last.
void Viewfinder::Loop::choose_object() {
  const int objects = owner_.orders_.state().objects;
  if (objects == 0) return say("this run cannot place objects");
  placing_ = placing_ + 1 < objects ? placing_ + 1 : -1;
  if (placing_ < 0) return say("placing ended");
  facts_.message.set("click where object {} of {} should stand", placing_ + 1, objects);
  message_until_ = owner_.clock_.now() + kMessage;
}

/// Places the chosen object, or focuses, at a clicked pixel; the picture has the view's pixels.
void Viewfinder::Loop::clicked(Window::Click click) {
  const Size size = drawn_.picture.size;
  if (click.x < 0 || click.y < 0 || click.x >= size.width || click.y >= size.height) return;
  const glm::ivec2 pixel(click.x, click.y);
  if (placing_ >= 0)
    return give(output::PlaceObject{std::exchange(placing_, -1), pixel}, "placing");
  if (!owner_.orders_.state().can_focus) return say("no depth of field: the scene has no [focus]");
  give(output::FocusAt{pixel}, "focused where you clicked");
}

/// Takes over the run's state; true where something in it is new.
bool Viewfinder::Loop::follow_run() {
  const RunNews news = follow(owner_.orders_.state(), state_);
  if (news.view) screen_.forget_range();
  if (news.placed) say(output::text(*news.placed));
  return news.any();
}

bool Viewfinder::Loop::handle_keys() {
  const ViewState before = state_;
  const Keys& keys = window_.poll();
  const auto click = window_.click();
  for (const char key : keys) {
    obey(press(key, state_));
    if (key == '1' + static_cast<char>(View::kDepth)) screen_.forget_range();
  }
  if (click) clicked(*click);  // the last key chose what it does
  owner_.reads_pixels_ = state_.on(Overlay::kZebra) || state_.on(Overlay::kPeaking);
  if (state_.view != before.view) give(output::ShowView{state_.view});
  if (state_.frozen != before.frozen) give(output::FreezePictures{state_.frozen});
  return !keys.empty() || click.has_value();
}

void Viewfinder::Loop::take(const Handed& handed, HostTime now) {
  last_arrival_ = now;
  const capture::Capture& capture = *handed.composite->capture;
  if (capture.status_of(capture::Stream::kDepth) != capture::StreamStatus::kMissing)
    last_depth_ = capture.mid_exposure;
  if (state_.frozen) return;
  composite_ = handed.composite;
  is_new_ = true;
}

void Viewfinder::Loop::ask_devices(HostTime now) {
  auto report = owner_.source_.report();
  if (report) {
    describe_fault(*report, facts_.fault);
    describe(*report, devices_ ? *devices_ : *report, seconds(now - asked_), facts_.sync);
  }
  devices_ = std::move(report);
  asked_ = now;
}

void Viewfinder::Loop::find_facts(HostTime now) {
  facts_.since_last = live_ ? now - last_arrival_ : Duration(0);  // a recording has no pace
  facts_.shown_hz = rate_.rate_hz(now);
  const output::RunState run = owner_.orders_.state();
  facts_.recording = run.can_record && run.recording;
  if (now >= message_until_) facts_.message.clear();
  facts_.age.reset(), facts_.without_depth.reset();
  if (composite_ == nullptr) return;
  const capture::Capture& capture = *composite_->capture;
  if (live_) facts_.age = now - capture.mid_exposure;
  if (capture.status_of(capture::Stream::kDepth) == capture::StreamStatus::kMissing)
    facts_.without_depth = capture.mid_exposure - last_depth_.value_or(capture.mid_exposure);
}

Result<void> Viewfinder::Loop::draw() {
  last_drawn_ = owner_.clock_.now();
  find_facts(last_drawn_);
  drawn_ = screen_.draw(composite_.get(), state_, facts_);
  return window_.show(drawn_, std::exchange(is_new_, false));
}

void Viewfinder::Loop::count_shown(const Handed& handed) {
  const HostTime now = owner_.clock_.now();
  rate_.add(now);
  ViewfinderReport& report = owner_.report_;
  ++report.shown;
  report.show_ms.add(milliseconds(now - handed.at));
  const capture::Capture& capture = *handed.composite->capture;
  if (output::ShownLog* const log = owner_.options_.log)
    log->add({capture.number, capture.mid_exposure, handed.at, now, handed.composite->frame_ms,
              measure::changed_column(drawn_.picture, log->empty, log->left_out)});
  if (!live_) return;
  facts_.delay = now - capture.mid_exposure;
  report.delay_ms.add(milliseconds(*facts_.delay));
}

Viewfinder::Viewfinder(const ViewfinderOptions& options, const capture::CaptureSource& source,
                       output::RunOrders& orders, const Clock& clock, ViewfinderReport& report)
    : options_(options), source_(source), orders_(orders), clock_(clock), report_(report) {
  orders.tell([&](output::RunState& run) { run.view = options.view; });
}

Viewfinder::~Viewfinder() { stop(); }

Result<std::unique_ptr<Viewfinder>> Viewfinder::create(const ViewfinderOptions& options,
                                                       const capture::CaptureSource& source,
                                                       output::RunOrders& orders,
                                                       const Clock& clock,
                                                       ViewfinderReport& report) {
  std::unique_ptr<Viewfinder> made(new Viewfinder(options, source, orders, clock, report));
  const auto opened = std::make_shared<Opened>();
  auto answer = opened->get_future();
  // SDL wants one thread for a window's whole life.
  made->thread_ = guarded_thread(
      "window", [sink = made.get(), opened] { return sink->serve(*opened); },
      [sink = made.get(), opened](const Error& error) {
        if (!sink->is_open_) return opened->set_value(error);
        sink->error_ = error;
        sink->failed_ = true;
      });
  if (const auto error = answer.get()) return *error;
  return made;
}

/// The window's thread. Sets `opened` when the window is there.
Result<void> Viewfinder::serve(Opened& opened) {
  MIXRIG_ASSIGN(const auto window,
                Window::open(options_.title, options_.picture_px, options_.shares));
  if (options_.shares && options_.log == nullptr) share_ = window->share();
  report_.driver = window->driver();
  is_open_ = true;
  opened.set_value(std::nullopt);
  return Loop(*this, *window).run();
}

void Viewfinder::stop() {
  over_ = true;
  queue_.close();
  if (thread_.joinable()) thread_.join();
  report_.replaced = queue_.dropped();
}

render::OutputMask Viewfinder::wanted(int) const {
  const render::OutputMask images = images_of(orders_.state().view);
  const bool stays = images == render::kColor && share_.display != nullptr && !reads_pixels_;
  return stays ? render::kGpuColor : images;
}

Result<void> Viewfinder::write(const output::CompositePtr& composite) {
  if (failed_) return *error_;
  queue_.push({composite, clock_.now()});
  return {};
}

Result<void> Viewfinder::finish() {
  stop();
  return failed_ ? Result<void>(*error_) : Result<void>();
}

}  // namespace mixrig::viewfinder
