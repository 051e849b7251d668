// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ObjectSpheres.h
 * @brief Bounding spheres of a scene's objects, in a tree that finds those that a beam sees small.
 *
 * An object is all that has one object id, whether its parts are connected or not. Nodes hold the
 * smallest and the largest radius below them. So a scene whose objects all look large from the
 * lidar, or all too small to matter, costs one visit of its root.
 *
 * Source: none.
 * Valid: objects with extent and finite corners; others have no sphere.
 * Test: TestSmallTargets.cxx (search against all spheres).
 */
#ifndef avianlidar_ObjectSpheres_h
#define avianlidar_ObjectSpheres_h

#include "BeamFrame.h"
#include "SharedVector.h"
#include "TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct ObjectSphere
{
  Vec3 center{ 0.0 };       ///< scene coordinates, m
  double radius = 0.0;      ///< m
  std::uint32_t number = 0; ///< of the object, in the order of their first triangles
  int id = 0;               ///< object id of its triangles, and of no others
};

/// Shares of a beam's solid angle that a search looks for, [from, to), and the sines of the
/// half-angles of such cones.
struct ShareWindow
{
  double from = 0.0;
  double to = 0.0;
  double least = 0.0; ///< sine
  double most = 0.0;  ///< sine; infinity if no sphere outside which the apex lies is too large
  double whole = 0.0; ///< 1 - cos of the half-beamwidth

  ShareWindow() = default;
  ShareWindow(double halfBeamwidth, double first, double end);
};

/// Immutable. 70 to 100 bytes an object.
class ObjectSpheres
{
public:
  /// Spheres about the centre of each object's box; O(triangles + objects log objects). Objects
  /// without extent, and those with a corner that is not finite, have none. @param geometry
  /// checksum of the mesh @param objectIds one per triangle, any ints; of another size: no objects
  ObjectSpheres(
    const TriangleMesh& mesh, std::uint64_t geometry, const SharedVector<int>& objectIds);

  /// Those of another scene, followed by those of objects that it lacks. @param others must outlive
  /// this @param objectIds one per triangle of `mesh`
  ObjectSpheres(
    const ObjectSpheres& others, const TriangleMesh& mesh, const SharedVector<int>& objectIds);

  /// True if the spheres were made from these.
  bool isOf(std::uint64_t geometry, const SharedVector<int>& objectIds) const
  {
    return this->Geometry == geometry && this->ObjectIds.sharesWith(objectIds);
  }

  std::size_t size() const { return this->Spheres.size(); }

  /// Hash of the partition of triangles into objects, whatever ids the objects have.
  std::uint64_t checksum() const { return this->Checksum; }

  /// A sphere that a beam meets, and the share of the beam's solid angle that the cone about it
  /// has.
  struct Seen
  {
    const ObjectSphere* sphere;
    double share;
  };

  /// Append the spheres that the beam meets and whose cones have shares in the window, the apex
  /// outside of them.
  void find(const BeamFrame& beam, const ShareWindow& window, std::vector<Seen>& seen) const;

private:
  struct Node
  {
    Vec3 center;     ///< centre of a sphere about all spheres below
    double radius;   ///< m
    double smallest; ///< radius of the spheres, m
    double largest;  ///< m
    std::uint32_t first;
    std::uint32_t count; ///< spheres of a leaf; else 0: the children are the next node and `first`
  };
  struct Search;
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  void visit(std::uint32_t node, Search& search) const;

  std::uint64_t Geometry;
  SharedVector<int> ObjectIds;
  std::uint64_t Checksum = 0;
  std::uint32_t Objects = 0;             ///< with spheres or without
  const ObjectSpheres* Others = nullptr; ///< null: none
  std::vector<ObjectSphere> Spheres;     ///< in the order of leaves
  std::vector<Node> Nodes;
};
}

#endif
