// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ExactTriangles.h
 * @brief Cache of triangles relative to an apex, for the exact functions of TriangleTest.h.
 * Neighbouring rays and beams mostly meet the same triangles.
 *
 * Source: none.
 * Valid: for one tree and apex at a time.
 * Test: TestRayPacket.cxx, TestVisiblePolygons.cxx.
 */
#ifndef avianlidar_ExactTriangles_h
#define avianlidar_ExactTriangles_h

#include "CollisionTree.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct ExactTriangle
{
  std::uint32_t number = NoTriangle;
  Corners corners;
  TrianglePlane plane;
};

/// @tparam Remembered largest number of triangles that are kept; a triangle's number gives the
/// place
template <std::uint32_t Remembered>
class ExactTriangles
{
  static_assert((Remembered & (Remembered - 1)) == 0, "a power of two");

public:
  /// Clear the cache if it belongs to another tree or apex.
  void begin(const CollisionTree& tree, const Vec3& apex)
  {
    if (this->Tree != &tree || this->Apex != apex)
    {
      this->Tree = &tree;
      this->Apex = apex;
      for (const std::uint32_t place : this->Used)
      {
        this->Last[place].number = NoTriangle;
      }
      this->Used.clear();
      while (this->Last.size() < std::min<std::size_t>(tree.mesh->size(), Remembered))
      {
        this->Last.resize(std::max<std::size_t>(2 * this->Last.size(), 16));
      }
    }
  }

  /// The triangle with this number. The reference is valid until the next call.
  const ExactTriangle& operator[](std::uint32_t number)
  {
    const auto at = static_cast<std::uint32_t>(number & (this->Last.size() - 1));
    ExactTriangle& place = this->Last[at];
    if (place.number != number)
    {
      if (place.number == NoTriangle)
      {
        this->Used.push_back(at);
      }
      place.number = number;
      place.corners = cornersFrom(*this->Tree->mesh, number, this->Apex);
      place.plane = planeOf(*this->Tree, number, place.corners, this->Apex);
    }
    return place;
  }

private:
  const CollisionTree* Tree = nullptr;
  Vec3 Apex{ 0.0 };
  std::vector<ExactTriangle> Last; ///< triangles kept; the size is 0 or a power of two
  std::vector<std::uint32_t> Used; ///< occupied places
};
}

#endif
