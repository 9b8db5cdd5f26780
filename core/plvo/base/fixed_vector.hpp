// SPDX-License-Identifier: Apache-2.0
// A vector over storage that it does not own (a span from the arena, or a std::array). It never grows:
// push_back into a full vector is refused and counted, so overflow is always reported.
#pragma once

#include <cassert>
#include <cstddef>
#include <span>
#include <type_traits>

namespace plvo {

template <typename T>
class FixedVector {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  constexpr FixedVector() = default;
  constexpr explicit FixedVector(std::span<T> storage) : data_(storage.data()), capacity_(storage.size()) {}

  // Returns false and increments dropped() when full.
  constexpr bool push_back(const T& value) {
    if (size_ == capacity_) {
      ++dropped_;
      return false;
    }
    data_[size_++] = value;
    return true;
  }
  constexpr void clear() {
    size_ = 0;
    dropped_ = 0;
  }
  // Sets the size to at most the capacity; elements that become part of it have the values that they had.
  constexpr void resize(std::size_t size) { size_ = size < capacity_ ? size : capacity_; }
  // Counts elements that the caller's own selection rule left out.
  constexpr void add_dropped(std::size_t count) { dropped_ += count; }

  constexpr std::size_t size() const { return size_; }
  constexpr std::size_t capacity() const { return capacity_; }
  constexpr std::size_t dropped() const { return dropped_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr bool full() const { return size_ == capacity_; }

  constexpr T& operator[](std::size_t i) {
    assert(i < size_);
    return data_[i];
  }
  constexpr const T& operator[](std::size_t i) const {
    assert(i < size_);
    return data_[i];
  }
  constexpr T* begin() { return data_; }
  constexpr T* end() { return data_ + size_; }
  constexpr const T* begin() const { return data_; }
  constexpr const T* end() const { return data_ + size_; }
  // The whole storage, up to capacity().
  constexpr std::span<T> storage() const { return {data_, capacity_}; }
  constexpr std::span<T> span() { return {data_, size_}; }
  constexpr std::span<const T> span() const { return {data_, size_}; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
  std::size_t dropped_ = 0;
};

}  // namespace plvo
