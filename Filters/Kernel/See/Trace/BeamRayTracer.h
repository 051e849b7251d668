// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamRayTracer.h
 * @brief Traces the rays of some beams: decides which beams are traced together, and in which way.
 *
 * Beams are grouped in clusters (BeamGroup.h). A cluster has as many beams as fill a packet of
 * rays, mostly one beam. From the entry points of a cluster, the cluster's rays descend further in
 * packets (RayPacket.h). Beams of fewer than eight rays form no groups and fill packets in the
 * order in which the beams come. Without a wide tree, or with TraceMode::Beams, each beam's cone
 * descends by itself. The leaves that the cone meets are then the entry points.
 *
 * Source: paper, Sec. 3.2.
 * Differs: see BeamGroup.h. A cone that meets more than 2048 triangles is traced ray by ray.
 * Valid: hits depend neither on packets nor on the order of rays.
 * Test: TestBeamGroup.cxx, TestBeamTracer.cxx, TestPacketOrder.cxx.
 */
#ifndef avianlidar_BeamRayTracer_h
#define avianlidar_BeamRayTracer_h

#include "BeamGroup.h"
#include "BeamTracer.h"
#include "PacketOrder.h"
#include "RayPacket.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Workspace kept between calls, so that no beam allocates.
struct BeamRayWorkspace
{
  BeamGroups groups;
  EntryPoints potential; ///< triangles that one beam may meet
  PacketWorkspace packets;
  RayPacket packet;
  PacketOrder order;
  TracedHits found;
  std::vector<std::uint32_t> triangles; ///< triangles that the rays of all beams hit
  std::size_t used = 0;                 ///< entries of `triangles` in use
};

/// Traces the rays of some beams, without movers, and puts hits and costs into `work.found`, which
/// must have no hits and no costs. The constructor's arguments must outlive the object.
class BeamRayTracer
{
public:
  BeamRayTracer(const SceneTriangles& scene, const TracedBeams& beams, BeamRayWorkspace& work);

  void trace(TraceMode mode);

private:
  void traceAlone(std::uint32_t beam);
  void rayByRay(std::uint32_t beam);
  void packets(const BeamCluster& cluster);
  void packetsOfBeam(std::uint32_t b, const EntryPoints* entryPoints);
  void packetOfBeams(const BeamCluster& cluster);
  void tracePacketOf(const EntryPoints* entryPoints, std::uint32_t beam);

  /// Memory for the hits of the next beam, which commitHits() assigns to a beam.
  std::uint32_t* nextHits() { return this->Work.triangles.data() + this->Work.used; }
  void commitHits(std::uint32_t beam, std::size_t count)
  {
    this->Work.found.triangles[beam] = this->nextHits();
    this->Work.used += count;
  }
  TraceCounters& counters(std::uint32_t beam) { return this->Work.found.counters[beam]; }

  const SceneTriangles& Scene;
  const CollisionTree& Tree;
  const TracedBeams& Beams;
  BeamRayWorkspace& Work;
};
}

#endif
