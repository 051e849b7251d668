// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SharedVector.h
 * @brief A constant vector whose copies share their elements, with a checksum of the elements.
 *
 * The data of every triangle of a large scene are in memory once and not three times, because
 * surfaces, scan and the tree's output share these data. The checksum says whether the data have
 * changed.
 *
 * Source: none.
 * Valid: elements that can be copied as bytes and have no gaps between members.
 * Test: TestScanAgain.cxx (vectors replaced between scans).
 */
#ifndef avianlidar_SharedVector_h
#define avianlidar_SharedVector_h

#include "Hash.h"

#include <cstddef>
#include <cstdint>
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
    , Checksum(this->empty() ? 0 : hashOf(this->data(), this->size() * sizeof(T), 0))
  {
    static_assert(std::is_trivially_copyable<T>::value, "elements are summarised as bytes");
  }

  std::size_t size() const { return this->Values->size(); }
  bool empty() const { return this->Values->empty(); }
  const T* data() const { return this->Values->data(); }
  const T* begin() const { return this->data(); }
  const T* end() const { return this->data() + this->size(); }
  const T& operator[](std::size_t i) const { return (*this->Values)[i]; }

  /// Checksum of the elements (Hash.h); 0 for an empty vector.
  std::uint64_t checksum() const { return this->Checksum; }

private:
  std::shared_ptr<const std::vector<T>> Values = std::make_shared<const std::vector<T>>();
  std::uint64_t Checksum = 0;
};
}

#endif
