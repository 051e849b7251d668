// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Tracers.h
 * @brief Who traces a workload: the traversal of this project, brute force, Embree, VTK's locators;
 * and whether two of them find the same hits, which is asked before any time is taken.
 */
#ifndef avianlidar_Tracers_h
#define avianlidar_Tracers_h

#include "BeamTracer.h"
#include "CollisionTree.h"
#include "EmbreeVersions.h"
#include "OneBeamTracer.h"
#include "Workload.h"

namespace benchmarks
{
/// Takes the hits of the rays [first, first + count), where they stand until it returns; called
/// from many threads. Empty: the rays are traced, and nothing else.
using Consumer =
  std::function<void(std::size_t first, const avianlidar::Hit* hits, std::size_t count)>;

/// Traces all rays of a workload with so many threads.
using Tracer = std::function<void(const Workload&, int threads, const Consumer&)>;

struct NamedTracer
{
  std::string name;
  Tracer trace;
};

/// All hits of a tracer, in the order of the rays.
std::vector<avianlidar::Hit> allHits(const Tracer& tracer, const Workload& workload, int threads);

/// BeamTracer on a tree that outlives it. What is timed ends with the nearest triangle of each ray,
/// found by ranges in single precision with bounds, as those of the peers are; the exact ranges are
/// another step of a scan (RaySamples), and computed here only for a consumer.
Tracer ourTracer(const avianlidar::CollisionTree& tree, avianlidar::TraceMode mode);

/// Every triangle against every ray: Moeller and Trumbore's test ("Fast, Minimum Storage
/// Ray-Triangle Intersection", 1997), double precision, no tree. Shares no code with the others.
Tracer bruteForce(const Scene& scene);

/// Embree (Wald et al., "Embree: A Kernel Framework for Efficient CPU Ray Tracing", ACM TOG 33(4),
/// 2014), used as its manual advises: flush-to-zero, coherent packets, static scene of medium build
/// quality. It works in single precision, so it gets the surfaces relative to the lidar.
class EmbreeScene
{
public:
  /// Copies the mesh and does not build yet.
  EmbreeScene(const Scene& scene, int buildThreads);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Builds the tree: all that rtcCommitScene() does.
  void build();

  /// Memory that Embree holds now, bytes: its copy of the mesh and the tree.
  std::size_t bytes() const { return static_cast<std::size_t>(this->Bytes); }

  /// Ray by ray.
  Tracer single() const;
  /// Sixteen rays at a time, with the coherent flag, in the order of the workload; a packet may
  /// hold rays of two beams, so that all are full.
  Tracer packets() const;

private:
  static bool countMemory(void* self, ssize_t bytes, bool post);
  RTCDevice Device;
  RTCScene Scene_;
  ssize_t Bytes = 0;
};

/// Version of the library and the widest packets it has code for on this machine.
std::string embreeDescription();

/// What a VTK user has today.
struct VtkPeer
{
  double buildSeconds;
  Tracer trace; ///< on one thread, whatever is asked
};

struct PeerMaker
{
  std::string name;
  std::function<VtkPeer(const Scene&)> make;
};

/// vtkStaticCellLocator, vtkModifiedBSPTree and vtkOBBTree. The second reads memory that nobody
/// wrote on many meshes (boxes; ParaView 5.11) and crashes: run it in a process of its own.
std::vector<PeerMaker> vtkPeers();

struct HitAgreement
{
  std::size_t rays = 0;
  std::size_t hits = 0;    ///< rays that hit in the first tracer
  std::size_t differ = 0;  ///< range differs by more than 1e-3, relative, or only one has a hit
  std::size_t atEdges = 0; ///< rays that differ within rounding of an edge

  /// Share of rays that neither agree nor pass an edge within the rounding of single precision.
  double unexplained() const
  {
    return this->rays ? static_cast<double>(this->differ - this->atEdges) / this->rays : 0.0;
  }
};

/// An edge explains a difference if the ray passes it within 1e-5 rad, or within what 16 roundings
/// of single precision at the triangle's farthest corner amount to at the hit.
HitAgreement compareHits(const Scene& scene, const Workload& work,
  const std::vector<avianlidar::Hit>& ours, const std::vector<avianlidar::Hit>& theirs);
}

#endif
