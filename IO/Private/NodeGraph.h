// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file NodeGraph.h
 * @brief The nodes of a scene graph in a mesh file, some of which stand in several places.
 */
#ifndef AvianLidarNodeGraph_h
#define AvianLidarNodeGraph_h

#include <cstddef>
#include <vector>

namespace avianlidar::scene
{
class NodeGraph
{
public:
  /// A new node; nodes are numbered from 0.
  std::size_t Add();
  void Connect(std::size_t parent, std::size_t child);
  std::size_t Size() const { return this->Children.size(); }

  /// Throws where nodes are more than 1000 deep or within themselves (Error), or stand in so many
  /// places that they do not fit into memory (MemoryError).
  void Check() const;

private:
  std::vector<std::vector<std::size_t>> Children;
};
}

#endif
