// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/v4l2/v4l2_buffers.h"

#include <atomic>

#include <sys/mman.h>
#include <unistd.h>

namespace mixrig::device {
namespace {

std::uint64_t next_set() {
  static std::atomic<std::uint64_t> sets = 0;
  return ++sets;
}

}  // namespace

V4l2Buffers::V4l2Buffers() : set_(next_set()) {}

V4l2Buffers::~V4l2Buffers() {
  for (const Planes& planes : planes_)
    for (const Mapping& mapping : planes)
      if (mapping.address != nullptr) ::munmap(mapping.address, mapping.bytes);
  for (const int fd : fds_)
    if (fd >= 0) ::close(fd);
}

V4l2Buffers::Planes& V4l2Buffers::add() {
  fds_.push_back(-1);
  returned_.reserve(fds_.size());
  return planes_.emplace_back();
}

DmaBuf V4l2Buffers::memory(std::uint32_t index, std::size_t offset_bytes) const {
  return {.fd = fds_[index], .offset_bytes = offset_bytes, .set = set_, .index = index};
}

bool V4l2Buffers::lend(std::uint32_t index, std::size_t kept) {
  const std::lock_guard lock(mutex_);
  if (fds_[index] < 0 || planes_.size() < lent_ + 1 + kept) return false;
  ++lent_;
  return true;
}

void V4l2Buffers::give_back(std::uint32_t index) {
  const std::lock_guard lock(mutex_);
  --lent_;
  returned_.push_back(index);
}

void V4l2Buffers::collect(std::vector<std::uint32_t>& indices) {
  const std::lock_guard lock(mutex_);
  indices.insert(indices.end(), returned_.begin(), returned_.end());
  returned_.clear();
}

void LentPicture::recycle() {
  if (buffers) buffers->give_back(index);
  buffers.reset();
  frame = {};
}

}  // namespace mixrig::device
