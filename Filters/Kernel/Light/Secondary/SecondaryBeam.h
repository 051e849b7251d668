// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryBeam.h
 * @brief A beam as the search for paths over two reflections sees it.
 */
#ifndef avianlidar_SecondaryBeam_h
#define avianlidar_SecondaryBeam_h

#include "BeamRays.h"
#include "BeamTracer.h"
#include "ParallelLoop.h"
#include "SecondaryTrace.h"
#include "Throughput.h"

#include <functional>

namespace avianlidar
{
/// What tracing on from the hits of a beam needs.
struct SecondaryScene
{
  const BeamFrame& frame;
  const BeamRays& rays;
  const SampleGeometry& geometry;
  BeamTracer& tracer;      ///< set to the beam
  std::uint64_t& segments; ///< counts those that are tested without the tracer
};

/// Everything about the beam that paths need; all must outlive the work.
struct SecondaryBeam
{
  std::uint64_t id;
  const BeamSamples& samples;
  Throughput& throughput;        ///< that of direct echoes is known; paths are added
  const StrataPartition* strata; ///< null for Monte Carlo
  SecondaryTrace& trace;
  std::function<SecondaryScene()> scene; ///< asked for when something is to be traced
  /// Asked now and then; false ends the work with WorkStopped.
  const std::function<bool()>* wanted = nullptr;

  /// A beam of a hundred thousand rays takes longer than a user wants to wait for a stop.
  void askWhetherWanted(std::size_t step) const
  {
    constexpr std::size_t interval = 4096;
    if (this->wanted && *this->wanted && step % interval == interval - 1 && !(*this->wanted)())
    {
      throw WorkStopped();
    }
  }
};

/// Ranges, unit directions and normals of the hits of a beam, for loops over lanes.
struct SampleLanes
{
  const double *range, *dx, *dy, *dz, *nx, *ny, *nz;

  SampleLanes(const BeamSamples& samples, const SampleGeometry& geometry)
    : range(samples.range.data())
    , dx(geometry.dx.data())
    , dy(geometry.dy.data())
    , dz(geometry.dz.data())
    , nx(geometry.nx.data())
    , ny(geometry.ny.data())
    , nz(geometry.nz.data())
  {
  }
};

/// A hit as the beginning or end of a segment.
struct HitPoint
{
  Vec3 point;
  Vec3 normal;
  double range;
  HitPoint(const BeamSamples& samples, const SampleGeometry& geometry, std::uint32_t hit)
    : point(samples.range[hit] * geometry.direction(hit))
    , normal(geometry.normal(hit))
    , range(samples.range[hit])
  {
  }
};
}

#endif
