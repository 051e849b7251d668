// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryBeam.h
 * @brief Inputs and results of the search for paths of a beam with two reflections.
 *
 * Source: none.
 * Valid: all objects that a SecondaryBeam refers to must outlive the search.
 * Test: TestSecondaryReflection.cxx, TestSecondaryPaths.cxx.
 */
#ifndef avianlidar_SecondaryBeam_h
#define avianlidar_SecondaryBeam_h

#include "BeamAir.h"
#include "BeamRays.h"
#include "BeamTracer.h"
#include "ParallelLoop.h"
#include "RangeUnits.h"
#include "SceneTriangles.h"
#include "SecondaryTrace.h"
#include "Throughput.h"
#include "VisiblePolygons.h"

#include <functional>

namespace avianlidar
{
/// Inputs and results of the search for paths with two reflections.
struct SecondaryBeam
{
  std::uint64_t id;
  const SceneTriangles& scene;
  const BeamFrame& frame;
  BeamTracer& tracer; ///< tracer set to this beam
  const BeamRays& rays;
  const BeamSamples& samples;     ///< rays from which paths start
  const SampleGeometry& geometry; ///< geometry of `samples`
  const Throughput& direct;       ///< direct echoes of `samples`
  const StrataPartition* strata;  ///< strata of `rays`; null for Monte Carlo
  SecondaryTrace& trace;
  double nearest; ///< lower bound of the ranges of the beam's surfaces, m
  /// Function called every StepsBetweenChecks steps of the search. If the function returns false,
  /// WorkStopped is thrown. Null: the work is never stopped.
  const std::function<bool()>* wanted = nullptr;
  /// Visible surfaces between which mirror paths go (MirrorRegions.h); null: mirror paths start
  /// from `samples`.
  const VisiblePolygons* surfaces = nullptr;
  /// Samples of a beam in cells, which give the shares of `surfaces`; null for other beams.
  const BeamSamples* cells = nullptr;
  const BeamAir* air = nullptr; ///< air along the beam; null: all media fill the scene
  /// Range units to which only the direct echoes have been added; null: all paths matter, however
  /// faint.
  RangeUnitAccumulator* units = nullptr;
  double faintBelow = 0.0; ///< energy of a unit, J, below which no echo contains the unit

  /// Throw WorkStopped if the work is no longer wanted. A beam of 100,000 rays takes longer than a
  /// user waits after an abort.
  void throwIfStopped(std::size_t step) const
  {
    if (this->wanted && *this->wanted && step % StepsBetweenChecks == StepsBetweenChecks - 1 &&
      !(*this->wanted)())
    {
      throw WorkStopped();
    }
  }
  static constexpr std::size_t StepsBetweenChecks = 4096;
};

/// Ranges, m, unit directions and normals of the hits of a beam, for SIMD loops.
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

/// A hit as the start or end of a segment, relative to the apex.
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
