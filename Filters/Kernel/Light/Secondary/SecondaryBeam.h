// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryBeam.h
 * @brief A beam as the search for paths over two reflections uses it: samples, geometry, tracer,
 * and where results go.
 *
 * Source: none.
 * Valid: holds references only; everything must outlive the search.
 * Test: TestSecondaryReflection.cxx, TestSecondaryPaths.cxx.
 */
#ifndef avianlidar_SecondaryBeam_h
#define avianlidar_SecondaryBeam_h

#include "BeamAir.h"
#include "BeamRays.h"
#include "BeamTracer.h"
#include "ParallelLoop.h"
#include "SceneTriangles.h"
#include "SecondaryTrace.h"
#include "Throughput.h"
#include "VisiblePolygons.h"

#include <functional>

namespace avianlidar
{
/// Inputs and results of the search; all must outlive it.
struct SecondaryBeam
{
  std::uint64_t id;
  const SceneTriangles& scene;
  const BeamFrame& frame;
  BeamTracer& tracer; ///< set to the beam
  const BeamRays& rays;
  const BeamSamples& samples;     ///< of the rays, where paths start
  const SampleGeometry& geometry; ///< of the samples
  const Throughput& direct;       ///< of the samples
  const StrataPartition* strata;  ///< null for Monte Carlo
  SecondaryTrace& trace;
  double nearest; ///< range, m: no surface of the beam is nearer
  /// Called every 4096 steps; false ends the work with WorkStopped.
  const std::function<bool()>* wanted = nullptr;
  /// What the beam sees, between whose surfaces mirror paths go (MirrorRegions.h); null: they are
  /// followed from the samples.
  const VisiblePolygons* surfaces = nullptr;
  const BeamSamples* cells = nullptr; ///< if the surfaces have hidden parts: what is seen of them
  BeamAir* air = nullptr;             ///< if the beam meets media that do not fill the scene
  double silentBelow = 0.0;           ///< J: if all paths bring less, the beam has no echo

  /// Throws WorkStopped if the work is no longer wanted: a beam of 100,000 rays takes longer than a
  /// user waits for an abort.
  void askWhetherWanted(std::size_t step) const
  {
    if (this->wanted && *this->wanted && step % StepsBetweenLooks == StepsBetweenLooks - 1 &&
      !(*this->wanted)())
    {
      throw WorkStopped();
    }
  }
  static constexpr std::size_t StepsBetweenLooks = 4096;
};

/// Ranges, unit directions and normals of the hits of a beam, for SIMD loops.
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

/// A hit as the start or end of a segment.
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
