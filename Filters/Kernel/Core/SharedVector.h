// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SharedVector.h
 * @brief A constant vector whose copies share their elements.
 *
 * The data of every triangle of a large scene are in memory once and not three times, because
 * surfaces, scan and the tree's output share these data.
 *
 * Source: none.
 * Valid: any elements. shareWith() requires elements that can be copied as bytes and have no gaps
 * between members.
 * Test: TestScanAgain.cxx (vectors replaced between scans).
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
    : Values(std::make_shared<const std::vector<T>>(std::move(values)))
  {
  }

  std::size_t size() const { return this->Values->size(); }
  bool empty() const { return this->Values->empty(); }
  const T* data() const { return this->Values->data(); }
  const T* begin() const { return this->data(); }
  const T* end() const { return this->data() + this->size(); }
  const T& operator[](std::size_t i) const { return (*this->Values)[i]; }
  bool sharesWith(const SharedVector& other) const { return this->Values == other.Values; }

  /// Share the elements of another vector if the elements of both vectors have the same bytes.
  void shareWith(const SharedVector& other)
  {
    static_assert(std::is_trivially_copyable<T>::value, "elements are compared as bytes");
    if (this->size() == other.size() &&
      (this->empty() || std::memcmp(this->data(), other.data(), this->size() * sizeof(T)) == 0))
    {
      *this = other;
    }
  }

private:
  std::shared_ptr<const std::vector<T>> Values = std::make_shared<const std::vector<T>>();
};
}

#endif
