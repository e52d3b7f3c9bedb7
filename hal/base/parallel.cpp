// SPDX-License-Identifier: Apache-2.0
#include "hal/base/parallel.h"

#include <algorithm>

#include <sched.h>

namespace mixrig {
namespace {

/// Cores that the calling thread may use; empty where the system does not say.
std::vector<int> allowed_cores() {
  cpu_set_t set;
  std::vector<int> cores;
  if (::sched_getaffinity(0, sizeof(set), &set) != 0) return cores;
  for (int i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(i, &set)) cores.push_back(i);
  return cores;
}

void keep_on(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  (void)::sched_setaffinity(0, sizeof(set), &set);
}

/// Keeps the calling thread on the first of `cores`, until it may use those that it had before.
class OnFirstCore {
 public:
  explicit OnFirstCore(std::span<const int> cores) {
    if (cores.empty() || ::sched_getaffinity(0, sizeof(before_), &before_) != 0) return;
    kept_ = true;
    keep_on(cores.front());
  }
  ~OnFirstCore() {
    if (kept_) (void)::sched_setaffinity(0, sizeof(before_), &before_);
  }
  OnFirstCore(const OnFirstCore&) = delete;
  OnFirstCore& operator=(const OnFirstCore&) = delete;

 private:
  bool kept_ = false;
  cpu_set_t before_;
};

}  // namespace

Crew::Crew(int threads) : cores_(allowed_cores()) {
  const int total = threads > 0 ? threads : std::max(1, static_cast<int>(cores_.size()));
  if (total != static_cast<int>(cores_.size())) cores_.clear();
  for (int i = 1; i < total; ++i) workers_.emplace_back([this, i] { work(i); });
}

Crew::~Crew() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
  for (auto& worker : workers_) worker.join();
}

void Crew::run(int count, int grain, Function function, void* context) {
  if (count <= 0) return;
  grain = std::max(1, grain);
  if (workers_.empty() || count <= grain) {
    for (int begin = 0; begin < count; begin += grain)
      function(context, 0, begin, std::min(begin + grain, count));
    return;
  }
  const OnFirstCore caller(cores_);
  {
    const std::lock_guard lock(mutex_);
    function_ = function;
    context_ = context;
    next_ = 0;
    count_ = count;
    grain_ = grain;
    ++generation_;
  }
  start_.notify_all();
  take_bands(0);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0 && next_ >= count_; });
}

void Crew::take_bands(int worker) {
  std::unique_lock lock(mutex_);
  ++busy_;
  while (next_ < count_) {
    const int begin = next_;
    const int end = std::min(begin + grain_, count_);
    next_ = end;
    const Function function = function_;
    void* const context = context_;
    lock.unlock();
    function(context, worker, begin, end);
    lock.lock();
  }
  if (--busy_ == 0) done_.notify_all();
}

void Crew::work(int worker) {
  if (!cores_.empty()) keep_on(cores_[static_cast<std::size_t>(worker)]);
  unsigned seen = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      start_.wait(lock, [&] { return stop_ || generation_ != seen; });
      if (stop_) return;
      seen = generation_;
    }
    take_bands(worker);
  }
}

}  // namespace mixrig
