// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayPacket.h
 * @brief Up to 64 rays from one apex descend the wide tree together, in single precision with
 * bounds of the error.
 *
 * If RayPacketTriangles.h leaves a hit undecided, the exact functions (PacketRanges.h) decide
 * immediately. The steps of a node depend on each other, so the time of a node hardly grows with
 * the number of rays. Only groups of sixteen rays that meet a leaf are tested against the triangles
 * of the leaf. For both reasons packets are wider than a vector. Packets of 128 rays are faster
 * than packets of 64 rays for narrow beams, and slower for fine meshes. Rays that lie closer
 * together share more nodes. The rays of a packet need not belong to one beam.
 *
 * Source: Wald, Slusallek, Benthin, Wagner, "Interactive Rendering with Coherent Ray Tracing",
 * Computer Graphics Forum 20(3), 2001; frustum: Reshetov, Soupikov, Hurley, "Multi-level Ray
 * Tracing Algorithm", ACM TOG 24(3), 2005.
 * Differs: rays are tested in groups of sixteen within a packet, eight boxes or triangles at a
 * time.
 * Valid: hits are bitwise identical to the hits of single rays. Rays are traced one by one if they
 * lie too far apart, if the apex is too far away, or if the tree has no wide form.
 * Test: TestRayPacket.cxx.
 */
#ifndef avianlidar_RayPacket_h
#define avianlidar_RayPacket_h

#include "ApexTriangles.h"
#include "BeamFrame.h"
#include "BeamTracer.h"
#include "CollisionTree.h"
#include "ExactTriangles.h"
#include "RayPacketTriangles.h"
#include "Traversal.h"
#include "WideTree.h"

#include <cstdint>

namespace avianlidar
{
struct alignas(64) RayPacket
{
  static constexpr int Width = PacketWidth;

  double x[Width], y[Width];       ///< coordinates in the plane of the ray's beam
  const BeamFrame* beam = nullptr; ///< frame of all rays; null if they belong to several beams
  const BeamFrame* frame[Width];   ///< frame of each ray, if `beam` is null; all of one origin
  std::uint32_t triangle[Width];   ///< nearest triangle of each ray (output), or NoTriangle
  int count = 0;                   ///< number of rays, 1 to Width; other lanes may be overwritten

  const BeamFrame& frameOf(int ray) const { return this->beam ? *this->beam : *this->frame[ray]; }
  /// Unit direction of a ray.
  Vec3 direction(int ray) const
  {
    return unitDirection(this->frameOf(ray).direction(this->x[ray], this->y[ray]));
  }
};

/// State of a packet during its descent.
struct PacketState
{
  RayPacket* packet = nullptr;
  int filled = 0;        ///< number of triangles collected for the next test
  float farthest = 0.0f; ///< largest `far` of the view
  PacketView view = {};
  PacketBest best = {};
  PacketTriangles triangles = {};
  int missing = 0; ///< number of triangles that are not in the table `known`
  std::uint32_t positions[PacketTriangles::Width];
  ApexTriangle fresh[PacketTriangles::Width];
  ApexTriangles known;
  ExactTriangles<64> exact;
};

/// Workspace kept between calls, so that no call allocates.
struct PacketWorkspace
{
  PacketState state;
  TraversalStack stack;
};

struct PacketCost
{
  std::uint64_t nodes = 0;     ///< number of nodes visited
  std::uint64_t triangles = 0; ///< number of triangles tested
};

/// Find the nearest triangles of the rays of a packet. @param entryPoints boxes that hold all
/// triangles that the rays may hit; null: the whole tree
PacketCost tracePacket(const CollisionTree& tree, RayPacket& packet, PacketWorkspace& work,
  const EntryPoints* entryPoints = nullptr);

/// Set the directions of rays and of padding lanes, in single precision.
void setDirections(RayPacket& packet, PacketView& view);
}

#endif
