// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EmbreePeer.h
 * @brief Embree (Wald et al., "Embree: A Kernel Framework for Efficient CPU Ray Tracing", ACM
 * TOG 33(4), 2014), used as its manual advises: flush-to-zero, coherent packets, static scene of
 * medium build quality.
 *
 * It works in single precision, so it gets the surfaces relative to the lidar.
 */
#ifndef avianlidar_EmbreePeer_h
#define avianlidar_EmbreePeer_h

#include "EmbreeVersions.h"
#include "Workload.h"

namespace benchmarks
{
class EmbreeScene
{
public:
  /// Copies the mesh and does not build yet.
  EmbreeScene(const Scene& scene, bool robust, int buildThreads);
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
}

#endif
