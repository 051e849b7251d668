// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SharedBlocks.h
 * @brief A vector in blocks, whose copies share each block until one of them writes to it.
 *
 * Materials of a large scene are changed for some objects at a time: what follows from them (sums,
 * checksums, what was repainted) is worked out anew for the blocks that are no longer shared.
 *
 * A copy costs a pointer for each 1024 elements, and so does the question of which blocks are
 * shared; the first write to a shared block copies it, every later one looks at a count.
 *
 * Any number of threads may read copies. One may write to its own only while no other makes, reads
 * or drops a copy that shares with it: the count of holders orders nothing between threads.
 */
#ifndef avianlidar_SharedBlocks_h
#define avianlidar_SharedBlocks_h

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace avianlidar
{
/// @tparam T compared as bytes: where it has gaps between its members, equal values may pass for
/// different ones
template <class T>
class SharedBlocks
{
  static_assert(std::is_trivially_copyable<T>::value, "elements are compared as bytes");

public:
  static constexpr std::size_t BlockSize = 1024;
  using Block = std::vector<T>;

  SharedBlocks() = default;
  /// Copies all values.
  explicit SharedBlocks(const std::vector<T>& values)
    : Size(values.size())
  {
    for (std::size_t i = 0; i < values.size(); i += BlockSize)
    {
      const std::size_t end = std::min(values.size(), i + BlockSize);
      this->Blocks.push_back(std::make_shared<Block>(values.begin() + i, values.begin() + end));
    }
  }

  /// The same: nothing is shared with others afterwards.
  SharedBlocks& operator=(const std::vector<T>& values) { return *this = SharedBlocks(values); }

  /// Share blocks with the same values: compares all bytes of both.
  void shareWith(const SharedBlocks& known)
  {
    for (std::size_t k = 0; k < std::min(this->blocks(), known.blocks()); ++k)
    {
      const Block& mine = this->block(k);
      const Block& other = known.block(k);
      if (mine.size() == other.size() &&
        std::memcmp(mine.data(), other.data(), mine.size() * sizeof(T)) == 0)
      {
        this->Blocks[k] = known.Blocks[k];
      }
    }
  }

  std::size_t size() const { return this->Size; }
  bool empty() const { return this->Size == 0; }
  const T& operator[](std::size_t i) const { return (*this->Blocks[i / BlockSize])[i % BlockSize]; }

  /// Writing takes a copy of the block first if others share it.
  T& operator[](std::size_t i)
  {
    std::shared_ptr<Block>& block = this->Blocks[i / BlockSize];
    if (block.use_count() > 1)
    {
      block = std::make_shared<Block>(*block);
    }
    return (*block)[i % BlockSize];
  }

  std::size_t blocks() const { return this->Blocks.size(); }
  const Block& block(std::size_t k) const { return *this->Blocks[k]; }
  bool sharesBlock(std::size_t k, const SharedBlocks& other) const
  {
    return k < other.blocks() && this->Blocks[k] == other.Blocks[k];
  }
  bool sharesWith(const SharedBlocks& other) const
  {
    return this->Size == other.Size && this->Blocks == other.Blocks;
  }

  /// Over the elements; dereferencing one of a vector that is not const is writing.
  template <class Vector, class Reference>
  struct Iterator
  {
    using iterator_category = std::forward_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = T*;
    using reference = Reference;
    Vector* vector;
    std::size_t place;
    Reference operator*() const { return (*this->vector)[this->place]; }
    Iterator& operator++()
    {
      ++this->place;
      return *this;
    }
    Iterator operator++(int)
    {
      Iterator before = *this;
      ++this->place;
      return before;
    }
    bool operator==(const Iterator& other) const { return this->place == other.place; }
    bool operator!=(const Iterator& other) const { return this->place != other.place; }
  };
  auto begin() const { return Iterator<const SharedBlocks, const T&>{ this, 0 }; }
  auto end() const { return Iterator<const SharedBlocks, const T&>{ this, this->Size }; }
  auto begin() { return Iterator<SharedBlocks, T&>{ this, 0 }; }
  auto end() { return Iterator<SharedBlocks, T&>{ this, this->Size }; }

private:
  std::size_t Size = 0;
  std::vector<std::shared_ptr<Block>> Blocks;
};
}

#endif
