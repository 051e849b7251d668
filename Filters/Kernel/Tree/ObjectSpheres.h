// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ObjectSpheres.h
 * @brief Bounding spheres of a scene's objects, in a tree by which a beam finds those that it sees
 * small.
 *
 * An object is what has one object id, whether its parts hang together or not. Nodes know the
 * smallest and the largest radius below them, so that a scene whose objects all look large from the
 * lidar, or all too small to matter, costs a look at its root.
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
  int id = 0;               ///< its triangles have this one, and no others
};

/// Shares of a beam's solid angle that a search is for: [from, to), and the sines of half-angles
/// that belong to them.
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
  /// About the centre of each object's box; O(triangles + objects log objects). Objects without
  /// extent, and those with a corner that is not finite, have none. @param geometry checksum of the
  /// mesh @param objectIds one per triangle, any ints; of another size: no objects
  ObjectSpheres(
    const TriangleMesh& mesh, std::uint64_t geometry, const SharedVector<int>& objectIds);

  /// True if it was made from these.
  bool isOf(std::uint64_t geometry, const SharedVector<int>& objectIds) const
  {
    return this->Geometry == geometry && this->ObjectIds.sharesWith(objectIds);
  }

  std::size_t size() const { return this->Spheres.size(); }

  /// Hash of which triangles are of one object, whatever ids the objects have.
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
    Vec3 center;     ///< of a sphere about all below
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
  std::vector<ObjectSphere> Spheres; ///< in the order of leaves
  std::vector<Node> Nodes;
};
}

#endif
