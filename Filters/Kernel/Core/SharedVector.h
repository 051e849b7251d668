// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SharedVector.h
 * @brief A constant vector whose copies share their elements, with a checksum of the elements.
 *
 * The data of every triangle of a large scene are in memory once, because surfaces and scans share
 * these data. Up to 65,536 different elements are stored once each, and every place of the vector
 * then takes two bytes. The checksum says whether the data have changed.
 *
 * Source: none.
 * Valid: elements that can be copied as bytes and have no gaps between members. Elements are equal
 * if their bytes are equal.
 * Test: TestScanAgain.cxx (vectors replaced between scans), TestSharedVector.cxx.
 */
#ifndef avianlidar_SharedVector_h
#define avianlidar_SharedVector_h

#include "Hash.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <unordered_map>
#include <vector>

namespace avianlidar
{
template <class T>
class SharedVector
{
public:
  SharedVector() = default;
  SharedVector(const std::vector<T>& values)
    : Checksum(values.empty() ? 0 : hashOf(values.data(), values.size() * sizeof(T), 0))
  {
    static_assert(std::is_trivially_copyable<T>::value, "elements are compared as bytes");
    auto elements = std::make_shared<Elements>();
    std::unordered_map<T, std::uint16_t, BytesHash, BytesEqual> numbers;
    constexpr std::size_t most = 65536;
    for (std::size_t i = 0; i < values.size() && numbers.size() <= most; ++i)
    {
      const bool isAsBefore = i > 0 && BytesEqual()(values[i], values[i - 1]);
      const auto next = static_cast<std::uint16_t>(numbers.size());
      elements->numbers.push_back(
        isAsBefore ? elements->numbers.back() : numbers.emplace(values[i], next).first->second);
      if (numbers.size() > elements->different.size())
      {
        elements->different.push_back(values[i]);
      }
    }
    if (numbers.size() > most)
    {
      *elements = { values, {} };
    }
    elements->numbers.shrink_to_fit();
    this->Content = elements;
  }

  std::size_t size() const
  {
    return this->isIndexed() ? this->Content->numbers.size() : this->Content->different.size();
  }
  bool empty() const { return this->Content->different.empty(); }
  const T& operator[](std::size_t i) const
  {
    return this->Content->different[this->isIndexed() ? this->Content->numbers[i] : i];
  }

  /// All different elements. If there are many, elements may be repeated.
  const std::vector<T>& different() const { return this->Content->different; }

  /// Checksum of the elements (Hash.h); 0 for an empty vector.
  std::uint64_t checksum() const { return this->Checksum; }

private:
  struct BytesHash
  {
    std::size_t operator()(const T& value) const { return hashOf(&value, sizeof value, 0); }
  };
  struct BytesEqual
  {
    bool operator()(const T& a, const T& b) const { return std::memcmp(&a, &b, sizeof a) == 0; }
  };
  struct Elements
  {
    std::vector<T> different;
    std::vector<std::uint16_t> numbers; ///< places in `different`; empty: `different` holds all
  };

  bool isIndexed() const { return !this->Content->numbers.empty(); }

  std::shared_ptr<const Elements> Content = std::make_shared<const Elements>();
  std::uint64_t Checksum = 0;
};
}

#endif
