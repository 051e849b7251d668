// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamLighting.h
 * @brief Second stage of a beam: the energies of all its paths, in range units.
 *
 * The paths are the direct echoes of all samples, and the paths with two reflections that the
 * light-energy constraint keeps. The constraint has these rules, with epsilon =
 * EchoSettings::lightEnergyFraction:
 *
 * - A path is dropped if its energy is less than epsilon Qlow / (number of paths of the beam). A
 *   path is not traced if an upper bound shows that it would be dropped.
 * - All secondary paths of a beam are skipped if the sum of their bounds and of the energy already
 *   dropped is less than epsilon Qlow.
 * - A secondary path is not traced if no range unit that it may reach can have the energy Qlow,
 *   even if nothing blocks any path. No path reaches a unit before its ends. This rule applies only
 *   if noise and air are too weak to be perceived.
 *
 * The samples of an integrated beam are nodes on its polygons (PolygonQuadrature.h). If the
 * polygons face each other, connections start from rays that meet the polygons. The samples of a
 * beam in cells are its strips (RangeStrips.h). Connections of such a beam start from the beam's
 * rays. Mirror paths of integrated beams and of beams in cells come from MirrorRegions.h.
 *
 * Source: paper, Eq. 4-9 and Sec. 3.4.
 * Differs: the constraint limits the energy that a whole range unit loses. A comparison of each
 * ray's energy with Qlow would remove every wall.
 * Valid: no range unit of an echo loses more than epsilon Qlow. The third rule changes no echo,
 * unless paths from random rays exceed the bound of their surface by chance.
 * Test: TestEchoClosedForms.cxx, TestSecondaryConstraints.cxx, TestScanAgain.cxx.
 */
#ifndef avianlidar_BeamLighting_h
#define avianlidar_BeamLighting_h

#include "BeamAir.h"
#include "BeamTrace.h"
#include "BlockBeams.h"
#include "PolygonQuadrature.h"
#include "RangeUnits.h"
#include "Receiver.h"
#include "SecondaryReflection.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// Computes the light of one beam after the other. Each thread needs its own object. The
/// constructor's arguments must outlive the object.
class BeamLighting
{
public:
  /// @param wanted function called every 4096 steps within a beam; WorkStopped is thrown if it
  /// returns false
  BeamLighting(const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams,
    BlockBeams& block, BeamSampler& sampler, const BeamReceiver& receiver, BeamAir& air,
    LeafGaps& gaps, std::function<bool()> wanted);

  /// Computes the light of beams even where bounds show that no energy can be perceived.
  void lightAll() { this->LightsAll = true; }

  /// Computes the light of a beam of the block, and adds new hits and paths to `trace`.
  /// @return false, with incomplete units and paths, if nothing of the beam can be perceived
  bool light(std::size_t beam, BeamTrace& trace);

  // Results for the beam lit last.
  const BeamSamples* samples() const { return this->Lit; } ///< samples of the direct echo, or null
  RangeUnitAccumulator& units() { return this->Units; }
  /// Energies of the direct echoes of the samples, J; empty if nothing can be perceived.
  const std::vector<double>& energies() const { return this->Energies; }
  /// The same, with the mean transmission of leaves.
  const std::vector<double>& meanEnergies() const
  {
    return this->Means.empty() ? this->Energies : this->Means;
  }
  const std::vector<SecondaryPath>& paths() const { return this->Paths; }
  /// Rays from which paths start; null if no path starts from rays.
  const BeamSamples* starts() const { return this->Starts; }
  bool raysAreLit() const { return this->Lit == this->Starts; }
  const CellSamples* cells() const { return this->Cells; } ///< samples of a beam in cells, or null
  /// Quadrature of the beam, if the beam is integrated.
  const PolygonQuadrature& quadrature() const { return this->Quadrature; }
  /// True if direct echoes arrive, all of them outside the range gate.
  bool isOutsideGate() const;
  BeamAir& air() { return this->Air; }
  /// Spectral radiance in the beam, W/(m2 sr nm) (Background.h).
  double radiance() const { return this->Radiance; }
  double lost() const { return this->Lost; }              ///< BeamReport::lost, J
  std::uint32_t skipped() const { return this->Skipped; } ///< BeamReport::skipped

private:
  bool placeSamples(std::size_t beam, BeamTrace& trace);
  bool placeNodes(std::size_t beam);
  bool mayBePerceived(std::size_t beam, double most, double ofPaths);
  bool onlySurfacesMatter() const;
  bool mayBeLeftOut(double farthest, double nearest) const;
  double nearestRange() const;
  bool isSkipped(double most, double farthest, double nearest);
  void startFrom(const BeamSamples& rays);
  bool reflectAgain(std::size_t beam, BeamTrace& trace, double most);
  bool collectPaths(std::size_t beam, BeamTrace& trace);
  void dropFaintPaths();
  double passMedia(std::size_t beam, double sum);
  void drawLeaves(std::size_t beam);
  void fillUnits();

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const ScanBeams& Beams;
  BlockBeams& Block;
  BeamSampler& Sampler;
  const BeamReceiver& Receiver;
  std::function<bool()> Wanted;
  SecondaryReflection Secondary;
  PolygonQuadrature Quadrature;
  RangeUnitAccumulator Units;
  BeamAir& Air;
  LeafGaps& Gaps;
  std::vector<LeafGaps::Sample> BehindLeaves; ///< samples in a beam that meets leaves
  bool LightsAll = false;

  // The beam being lit.
  const BeamSamples* Lit = nullptr;    ///< samples of the direct echo
  const BeamSamples* Starts = nullptr; ///< rays from which paths start; null: no such rays
  // Empty members, for beams whose paths start from no ray.
  const BeamSamples NoStarts;
  const BeamRays NoRays;
  const SampleGeometry NoGeometry;
  const CellSamples* Cells = nullptr; ///< samples of a beam in cells, or null
  /// Surfaces that the beam sees, for MirrorRegions.h, with hidden parts if the beam is in cells;
  /// null: mirror paths start from rays.
  const VisiblePolygons* Surfaces = nullptr;
  bool MayReflectTwice = false; ///< whether an integrated beam may have paths with two reflections
  Throughput OfLit;             ///< throughputs of the direct echoes of `Lit`
  Throughput OfStarts;          ///< throughputs of direct echoes of `Starts`, if not `Lit`
  std::vector<double> Energies; ///< energies of the direct echoes, J
  std::vector<double> Means;    ///< meanEnergies(); empty if no leaves are drawn
  std::vector<SecondaryPath> Paths;
  double Direct = 0.0;              ///< sum of `Energies` before paths are dropped, J
  double DroppedByQuadrature = 0.0; ///< result of PolygonQuadrature::dropped(), J
  double Radiance = 0.0;
  double Lost = 0.0;
  std::uint32_t Skipped = 0;
};
}

#endif
