// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneTriangles.h
 * @brief The triangles that a beam may meet: the triangles of the collision tree, and the triangles
 * of movers at the places that the movers have when the beam is fired.
 *
 * Triangles of the tree keep their numbers. The numbers of all movers' triangles follow, whether
 * the movers are placed or not, so that a number means one triangle throughout a scan.
 *
 * Source: none.
 * Valid: a mover's triangle never takes the plane of another triangle (CoincidentFaces.h).
 * Test: TestMovedBeams.cxx.
 */
#ifndef avianlidar_SceneTriangles_h
#define avianlidar_SceneTriangles_h

#include "CollisionTree.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// The triangles of the tree, and of the movers that were placed since the last clear(). Each
/// thread needs its own object. The tree must outlive the object.
class SceneTriangles
{
public:
  explicit SceneTriangles(const CollisionTree& tree)
    : Tree(tree)
    , Mesh(*tree.mesh)
    , Fixed(static_cast<std::uint32_t>(tree.mesh->size()))
  {
  }

  const CollisionTree& tree() const { return this->Tree; }

  /// Numbers of the movers' triangles in the beam, in rising order.
  const std::vector<std::uint32_t>& moved() const { return this->Numbers; }

  /// Tree of the triangles in moved(), numbered by places in moved(); null if moved() has few
  /// triangles.
  const CollisionTree* movedTree() const { return this->MovedTree.get(); }

  void clear();

  /// Place a mover, after the movers with lower numbers. @param first number of the mover's first
  /// triangle
  /// @param mesh triangles of the mover in scene coordinates, m
  void place(std::uint32_t first, const TriangleMesh& mesh);

  /// Build the tree of the movers' triangles, after the last mover is placed.
  void finish();

  /// True if the triangle belongs to the tree, or to a mover that is placed.
  bool holds(std::uint32_t triangle) const
  {
    return triangle < this->Fixed ||
      std::binary_search(this->Numbers.begin(), this->Numbers.end(), triangle);
  }

  bool isMoved(std::uint32_t triangle) const { return triangle >= this->Fixed; }

  /// A corner in scene coordinates, m.
  const Vec3& corner(std::uint32_t triangle, int c) const
  {
    return this->isMoved(triangle) ? this->Moved[triangle - this->Fixed][c]
                                   : this->Mesh.corner(triangle, c);
  }

  /// Corners relative to a point, m.
  Corners cornersFrom(std::uint32_t triangle, const Vec3& point) const
  {
    return { this->corner(triangle, 0) - point, this->corner(triangle, 1) - point,
      this->corner(triangle, 2) - point };
  }

  /// These functions mean the same as the functions of CollisionTree with the same names. A mover's
  /// triangle coincides with no other triangle and owns its plane.
  bool coincides(std::uint32_t triangle) const
  {
    return !this->isMoved(triangle) && this->Tree.coincides(triangle);
  }
  std::uint32_t planeOwner(std::uint32_t triangle) const
  {
    return this->isMoved(triangle) ? triangle : this->Tree.planeOwner(triangle);
  }

  /// The plane from which ranges on a triangle follow: the triangle's own plane, or the plane of
  /// its planeOwner().
  /// @param corners relative to `point`
  TrianglePlane planeOf(std::uint32_t triangle, const Corners& corners, const Vec3& point) const
  {
    return this->isMoved(triangle) ? avianlidar::planeOf(corners)
                                   : avianlidar::planeOf(this->Tree, triangle, corners, point);
  }

private:
  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  const std::uint32_t Fixed;              ///< number of triangles in the tree
  std::vector<std::array<Vec3, 3>> Moved; ///< corners of the movers' triangles that were placed, m
  std::vector<std::uint32_t> Numbers;
  std::shared_ptr<const CollisionTree> MovedTree;
};
}

#endif
