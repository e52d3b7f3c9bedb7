// SPDX-License-Identifier: Apache-2.0
// The viewfinder as a sink: shows every composite in a window, in its own thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "hal/base/bounded_queue.h"
#include "hal/base/clock.h"
#include "hal/base/quantile_sketch.h"
#include "host/capture/capture/capture_source.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"
#include "host/output/sink/shown_log.h"
#include "host/output/viewfinder/view_state.h"

namespace mixrig::viewfinder {

struct ViewfinderOptions {
  std::string title = "mixrig";
  View view = View::kComposite;
  Size picture_px;  ///< size of the window on a desktop
  bool help = false;
  bool shares = false;              ///< composites may stay in GPU memory (Viewfinder::share)
  output::ShownLog* log = nullptr;  ///< for a measurement; must outlive the sink
};

/// Counts and times of a run; complete when the sink has finished.
struct ViewfinderReport {
  std::string driver;                ///< SDL's driver and renderer, such as "x11, software"
  std::uint64_t shown = 0;           ///< composites shown
  std::uint64_t replaced = 0;        ///< composites replaced by newer ones before they were shown
  measure::QuantileSketch show_ms;   ///< handing over the composite to showing it
  measure::QuantileSketch delay_ms;  ///< live: mid-exposure to being shown
};

/// Shows the view in the run's state, and turns keys into orders. write() hands the composite to
/// the thread that owns the window and does not wait. That thread draws, shows and handles keys,
/// and continues while no composite comes: an old picture is marked as such. Closing the window
/// ends the run like Ctrl-C.
class Viewfinder final : public output::CompositeSink {
 public:
  /// Opens the window. Source, orders, clock and report must outlive the sink. Asks the source for
  /// the state of its devices twice a second. Errors: those of Window::open.
  static Result<std::unique_ptr<Viewfinder>> create(const ViewfinderOptions& options,
                                                    const capture::CaptureSource& source,
                                                    output::RunOrders& orders, const Clock& clock,
                                                    ViewfinderReport& report);
  ~Viewfinder() override;

  /// The context that the run's compositors share, so that composites need not be read back; empty
  /// if SDL does not draw by OpenGL ES, or `shares` is false. These compositors must end before the
  /// sink.
  render::GlShare share() const { return share_; }
  /// Makes composites be read back nevertheless. Call it before the run begins.
  void forget_share() { share_ = {}; }

  std::string_view name() const override { return "viewfinder"; }
  render::OutputMask wanted(int number) const override;
  /// Errors: kDevice if the picture could not be shown.
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override;

 private:
  struct Handed {
    output::CompositePtr composite;
    HostTime at{};
  };
  class Loop;
  using Opened = std::promise<std::optional<Error>>;

  Viewfinder(const ViewfinderOptions& options, const capture::CaptureSource& source,
             output::RunOrders& orders, const Clock& clock, ViewfinderReport& report);
  void stop();
  Result<void> serve(Opened& opened);

  const ViewfinderOptions options_;
  const capture::CaptureSource& source_;
  output::RunOrders& orders_;
  const Clock& clock_;
  ViewfinderReport& report_;
  /// Composites are needed in host memory, to draw marks from their pixels.
  std::atomic<bool> reads_pixels_ = false;
  render::GlShare share_;
  BoundedQueue<Handed, 1> queue_;
  std::atomic<bool> over_ = false;
  bool is_open_ = false;  ///< used by the thread alone
  std::atomic<bool> failed_ = false;
  std::optional<Error> error_;  ///< of the thread; read after failed_ is set
  std::thread thread_;
};

}  // namespace mixrig::viewfinder
