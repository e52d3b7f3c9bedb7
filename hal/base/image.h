// SPDX-License-Identifier: Apache-2.0
// Images as plain memory: an owner with aligned rows, and views that borrow.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace mixrig {

struct Size {
  int width = 0;
  int height = 0;
  bool operator==(const Size&) const = default;
  bool empty() const { return width <= 0 || height <= 0; }
  std::size_t area() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb8&) const = default;
};
/// An Rgb8 with a fourth byte, whose meaning its user defines.
struct Rgbx8 {
  std::uint8_t r = 0, g = 0, b = 0, x = 0;
};
struct Rgbf {
  float r = 0, g = 0, b = 0;
};

/// Borrowed pixels, row-major; `stride` counts pixels from row to row (>= width).
template <typename T>
struct ImageView {
  T* data = nullptr;
  Size size;
  std::ptrdiff_t stride = 0;

  T* row(int y) const { return data + static_cast<std::ptrdiff_t>(y) * stride; }
  T& at(int x, int y) const {
    assert(x >= 0 && x < size.width && y >= 0 && y < size.height);
    return row(y)[x];
  }
  bool empty() const { return data == nullptr || size.empty(); }
  operator ImageView<const T>() const  // NOLINT(google-explicit-constructor)
      requires(!std::is_const_v<T>) {
    return {data, size, stride};
  }
};

/// Owned pixels of a trivially copyable type; rows start on 64-byte borders.
template <typename T>
class Image {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Image() = default;
  explicit Image(Size size, T fill = T{}) { reset(size, fill); }
  Image(const Image& other) { *this = other; }
  Image& operator=(const Image& other) {
    if (this == &other) return *this;
    allocate(other.size_);
    std::copy_n(other.data_.get(), count(), data_.get());
    return *this;
  }
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    Image moved(std::move(other));
    swap(moved);
    return *this;
  }

  /// Gives the image this size and fills it; keeps the memory where the size stays.
  void reset(Size size, T fill = T{}) {
    if (size != size_) allocate(size);
    std::fill_n(data_.get(), count(), fill);
  }
  void fill(T value) { std::fill_n(data_.get(), count(), value); }

  Size size() const { return size_; }
  int width() const { return size_.width; }
  int height() const { return size_.height; }
  bool empty() const { return size_.empty(); }
  std::ptrdiff_t stride() const { return stride_; }

  T* row(int y) { return data_.get() + static_cast<std::ptrdiff_t>(y) * stride_; }
  const T* row(int y) const { return data_.get() + static_cast<std::ptrdiff_t>(y) * stride_; }
  T& at(int x, int y) { return view().at(x, y); }
  const T& at(int x, int y) const { return view().at(x, y); }
  ImageView<T> view() { return {data_.get(), size_, stride_}; }
  ImageView<const T> view() const { return {data_.get(), size_, stride_}; }
  operator ImageView<T>() { return view(); }              // NOLINT(google-explicit-constructor)
  operator ImageView<const T>() const { return view(); }  // NOLINT(google-explicit-constructor)

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::size_t count() const {
    return static_cast<std::size_t>(stride_) * static_cast<std::size_t>(size_.height);
  }
  void allocate(Size size) {
    constexpr std::size_t kAlign = 64;
    const std::size_t row_bytes =
        (static_cast<std::size_t>(std::max(size.width, 0)) * sizeof(T) + kAlign - 1) / kAlign *
        kAlign;
    // Rows hold a whole number of pixels only if sizeof(T) divides 64; others are packed.
    stride_ = kAlign % sizeof(T) == 0 ? static_cast<std::ptrdiff_t>(row_bytes / sizeof(T))
                                      : std::max(size.width, 0);
    size_ = size;
    const std::size_t bytes = (count() * sizeof(T) + kAlign) / kAlign * kAlign;
    data_.reset(static_cast<T*>(std::aligned_alloc(kAlign, bytes)));
    if (data_) return;
    size_ = {}, stride_ = 0;
    throw std::bad_alloc();
  }
  void swap(Image& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(stride_, other.stride_);
  }

  std::unique_ptr<T[], Free> data_;
  Size size_;
  std::ptrdiff_t stride_ = 0;
};

}  // namespace mixrig
