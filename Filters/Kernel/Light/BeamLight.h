// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamLight.h
 * @brief The light of one beam that arrives at the lidar: samples, energies, paths and range units.
 *
 * Source: paper, Eq. 4-10.
 * Differs: see BeamLighting.h.
 * Valid: `seen`, `cells` and `starts` point into the view of the beam, which must stay.
 * Test: TestScan.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_BeamLight_h
#define avianlidar_BeamLight_h

#include "LeafGaps.h"
#include "PolygonRule.h"
#include "RangeStrips.h"
#include "RangeUnits.h"
#include "SecondaryReflection.h"
#include "Throughput.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// The part of a beam's light on which returns depend.
struct ArrivingLight
{
  const std::vector<RangeUnit>& units;     ///< range units with light, ascending
  const std::vector<MetSurface>& surfaces; ///< result of BeamAir::arrange()
  double radiance;                         ///< spectral radiance in the beam, W/(m2 sr nm)
};

struct BeamLight
{
  explicit BeamLight(const Sensor& sensor)
    : units(sensor)
  {
  }

  /// Whether something of the beam may be perceived. If not, energies, paths and units are
  /// incomplete.
  bool isPerceivable = false;
  bool isIntegrated = false;          ///< whether the samples are `nodes`
  const BeamSamples* seen = nullptr;  ///< samples of the view, of a beam that is not integrated
  const CellSamples* cells = nullptr; ///< samples of a beam in cells, or null
  PolygonNodes nodes;                 ///< samples of an integrated beam
  Throughput direct;                  ///< throughputs of the direct echoes of the samples
  /// Energies of the direct echoes of the samples, J; incomplete unless `isPerceivable`.
  std::vector<double> energies;
  std::vector<double> means;           ///< see meanEnergies(); empty if no leaves are drawn
  DrawnLeaves leaves;                  ///< leaves drawn in the beam
  double mostOfPaths = 0.0;            ///< bound of the energy of paths with two reflections, J
  const BeamSamples* starts = nullptr; ///< hits from which paths start; may be null
  std::vector<SecondaryPath> paths;
  RangeUnitAccumulator units;       ///< energies of direct echoes and paths, in range units
  std::vector<MetSurface> surfaces; ///< samples of surfaces, which shadow the air
  double radiance = 0.0;            ///< spectral radiance in the beam, W/(m2 sr nm) (Background.h)
  double lost = 0.0;                ///< BeamReport::lost, J
  std::uint32_t skipped = 0;        ///< BeamReport::skipped

  /// Samples of the direct echo; null if the beam meets no surface.
  const BeamSamples* samples() const
  {
    return this->isIntegrated ? &this->nodes.samples : this->seen;
  }
  /// True if paths start at the samples themselves.
  bool raysAreLit() const { return this->starts && this->samples() == this->starts; }
  /// Energies of the direct echoes with the mean transmission of leaves, J.
  const std::vector<double>& meanEnergies() const
  {
    return this->means.empty() ? this->energies : this->means;
  }
  /// The path of a contribution to `units`, or null for a direct echo. The direct echoes of the
  /// samples are the first contributions, followed by `paths`.
  const SecondaryPath* pathOf(std::uint32_t contribution) const
  {
    const std::size_t first = this->energies.size();
    return contribution < first ? nullptr : &this->paths[contribution - first];
  }
  ArrivingLight arriving() const { return { this->units.units(), this->surfaces, this->radiance }; }

  /// True if direct echoes arrive, all of them outside the range gate.
  bool isOutsideGate() const;
  /// Lower bound of the ranges of the samples, m. A strip of cells begins before its mean.
  double nearestRange() const;

  /// Begin without samples, and keep the memory. @param sky radiance without surfaces, W/(m2 sr nm)
  void clear(double sky);
};
}

#endif
