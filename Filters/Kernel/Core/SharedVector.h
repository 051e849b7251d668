// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SharedVector.h
 * @brief A vector whose copies share their elements until one of them is written to.
 *
 * What belongs to every triangle of a large scene is held by the surfaces, by the tree's output
 * and by the scan: in memory once, not three times.
 *
 * Source: none.
 * Valid: any elements; shareWith() needs elements that can be copied as bytes, without gaps
 * between members.
 * Test: TestScanAgain.cxx (written copies), TestSmallTargets.cxx.
 */
#ifndef avianlidar_SharedVector_h
#define avianlidar_SharedVector_h

#include <cstddef>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace avianlidar
{
template <class T>
class SharedVector
{
public:
  SharedVector() = default;
  SharedVector(std::vector<T> values)
    : Values(std::make_shared<std::vector<T>>(std::move(values)))
  {
  }

  std::size_t size() const { return this->Values->size(); }
  bool empty() const { return this->Values->empty(); }
  const T* data() const { return this->Values->data(); }
  const T* begin() const { return this->data(); }
  const T* end() const { return this->data() + this->size(); }
  const T& operator[](std::size_t i) const { return (*this->Values)[i]; }
  bool sharesWith(const SharedVector& other) const { return this->Values == other.Values; }

  /// Share the elements of another vector if they are the same bytes. @tparam T without gaps
  /// between its members
  void shareWith(const SharedVector& other)
  {
    static_assert(std::is_trivially_copyable<T>::value, "elements are compared as bytes");
    if (this->size() == other.size() &&
      (this->empty() || std::memcmp(this->data(), other.data(), this->size() * sizeof(T)) == 0))
    {
      *this = other;
    }
  }

  // Writing takes a copy first if there are others.
  T* begin() { return this->own().data(); }
  T* end() { return this->own().data() + this->size(); }
  T& operator[](std::size_t i) { return this->own()[i]; }
  void assign(std::size_t count, const T& value)
  {
    this->Values = std::make_shared<std::vector<T>>(count, value);
  }

private:
  std::vector<T>& own()
  {
    if (this->Values.use_count() > 1)
    {
      this->Values = std::make_shared<std::vector<T>>(*this->Values);
    }
    return *this->Values;
  }

  std::shared_ptr<std::vector<T>> Values = std::make_shared<std::vector<T>>();
};
}

#endif
