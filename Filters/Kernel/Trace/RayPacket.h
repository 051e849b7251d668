// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayPacket.h
 * @brief Up to 64 rays from one apex down the wide tree: for beams of few rays (packets filled
 * over neighbouring beams) and for triangles finer than the spacing of rays.
 *
 * Nearly all work is done in single precision with bounds of the error, in vectors of rays
 * (RayPacketBoxes.h, RayPacketTriangles.h). What these leave undecided goes to the functions of
 * TriangleTest.h at once: hits are those of single rays.
 *
 * Cost: a node is a chain of dependent steps that hardly grows with the rays that go through it;
 * only groups of sixteen rays that meet a leaf are tested with its triangles. So packets are wider
 * than a vector: of 64 rays that see the same meadow most nodes are met by several groups (128 are
 * better for narrow beams and worse for fine meshes). Rays that lie closer together share more;
 * which beams they belong to does not matter. Packets after Wald, Slusallek, Benthin and Wagner,
 * "Interactive Rendering with Coherent Ray Tracing", Computer Graphics Forum 20(3), 2001; frustum
 * after Reshetov, Soupikov and Hurley, "Multi-level Ray Tracing Algorithm", ACM TOG 24(3), 2005.
 */
#ifndef avianlidar_RayPacket_h
#define avianlidar_RayPacket_h

#include "ApexTriangles.h"
#include "BeamFrame.h"
#include "BeamTracer.h"
#include "CollisionTree.h"
#include "EntryPoints.h"
#include "RayPacketTriangles.h"
#include "Traversal.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct alignas(64) RayPacket
{
  static constexpr int Width = PacketWidth;

  double x[Width], y[Width];       ///< in the plane of the ray's beam
  const BeamFrame* beam = nullptr; ///< if all rays belong to one; null: to several
  const BeamFrame* frame[Width];   ///< else of each ray's beam; all with the same origin
  std::uint32_t triangle[Width];   ///< out: the nearest ones
  int count = 0;                   ///< rays, 1 to Width; lanes beyond may be overwritten

  const BeamFrame& frameOf(int ray) const { return this->beam ? *this->beam : *this->frame[ray]; }
  /// unitDirection(), for one ray.
  Vec3 direction(int ray) const
  {
    return unitDirection(this->frameOf(ray).direction(this->x[ray], this->y[ray]));
  }
};

/// Triangles as the exact functions need them, relative to the apex: what neighbouring rays and
/// packets hit is mostly the same, so the last few are remembered.
class ExactTriangles
{
public:
  struct Triangle
  {
    std::uint32_t number = NoTriangle;
    Corners corners;
    TrianglePlane plane;
  };

  /// Forgets what belongs to another mesh or apex.
  void begin(const TriangleMesh& mesh, const Vec3& apex)
  {
    if (this->Mesh != &mesh || this->Apex != apex)
    {
      this->Mesh = &mesh;
      this->Apex = apex;
      for (const std::uint32_t number : this->Used)
      {
        this->Last[number].number = NoTriangle;
      }
      this->Used.clear();
    }
  }

  /// Stands until the next call.
  const Triangle& operator[](std::uint32_t number)
  {
    Triangle& place = this->Last[number % Remembered];
    if (place.number != number)
    {
      if (place.number == NoTriangle)
      {
        this->Used.push_back(number % Remembered);
      }
      place.number = number;
      place.corners = cornersFrom(*this->Mesh, number, this->Apex);
      place.plane = planeOf(place.corners);
    }
    return place;
  }

private:
  static constexpr std::uint32_t Remembered = 64;
  const TriangleMesh* Mesh = nullptr;
  Vec3 Apex{ 0.0 };
  Triangle Last[Remembered];
  std::vector<std::uint32_t> Used; ///< places of these
};

/// A packet under way.
struct PacketState
{
  RayPacket* packet = nullptr;
  int filled = 0;        ///< triangles that wait
  float farthest = 0.0f; ///< largest of the view's `far`
  PacketView view = {};
  PacketBest best = {};
  PacketTriangles triangles = {};
  int missing = 0; ///< of these, not in the table of `known`
  std::uint32_t positions[PacketTriangles::Width];
  ApexTriangle fresh[PacketTriangles::Width];
  ApexTriangles known;
  ExactTriangles exact;
};

/// Kept between the calls for one tree, so that none allocates.
struct PacketWorkspace
{
  PacketState state;
  TraversalStack stack;
};

/// What a packet cost.
struct PacketCost
{
  std::uint64_t nodes = 0;     ///< whose volume was tested
  std::uint64_t triangles = 0; ///< that were looked at
};

/// Nearest triangles of the rays of a packet. `entryPoints`: boxes that hold all triangles that
/// the rays may hit; null: the whole tree.
PacketCost tracePacket(const CollisionTree& tree, RayPacket& packet, PacketWorkspace& work,
  const EntryPoints* entryPoints = nullptr);

/// Directions of the packet's rays, and of lanes that pad the last group, in single precision.
void setDirections(RayPacket& packet, PacketView& view);
}

#endif
