// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/capture_reader.h"

#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/thread_priority.h"

namespace mixrig::capture {

CaptureReader::CaptureReader(CaptureSource& source, int first, int last, bool with_truth,
                             WorkGate* gate)
    : source_(source), gate_(gate), with_truth_(with_truth), live_(source.info().is_live()) {
  thread_ = std::thread([this, first, last] { run(first, last); });
}

CaptureReader::~CaptureReader() {
  stop_ = true;
  queue_.close();
  thread_.join();
}

Result<std::optional<CaptureItem>> CaptureReader::next() {
  std::optional<Slot> slot = queue_.pop();
  if (!slot) return std::optional<CaptureItem>();
  if (slot->error) return *std::move(slot->error);
  return std::optional<CaptureItem>(std::move(slot->item));
}

void CaptureReader::run(int first, int last) {
  // A recording has no deadline, and its run measures the compositor's times.
  if (!live_) lower_thread_priority();
  for (int number = first; !stop_; ++number) {
    Slot slot;
    bool there = false;
    const Result<void> done = guarded("reading", [&]() -> Result<void> {
      MIXRIG_ASSIGN(there, read(number, slot.item));
      return {};
    });
    if (!done) slot.error = done.error();
    if (done && !there) break;
    if (!push(std::move(slot)) || !done || number == last) break;
  }
  queue_.close();
}

Result<bool> CaptureReader::read(int number, CaptureItem& item) {
  const WorkGate::Work work(gate_);
  std::shared_ptr<Capture> capture = captures_.take();
  MIXRIG_ASSIGN(const bool there, source_.read(number, *capture));
  if (!there) return false;
  item.capture = std::move(capture);
  if (!with_truth_) return true;
  std::shared_ptr<Truth> truth = truths_.take();
  MIXRIG_TRY(source_.read_truth(number, *truth));
  item.truth = std::move(truth);
  return true;
}

bool CaptureReader::push(Slot slot) {
  if (!live_) return queue_.hand_over(std::move(slot));
  queue_.push(std::move(slot));
  return true;
}

}  // namespace mixrig::capture
