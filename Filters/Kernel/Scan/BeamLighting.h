// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamLighting.h
 * @brief Second stage of a beam: the energies of all its paths, in range units.
 *
 * These are the direct echoes of all samples and the paths over two reflections that the
 * light-energy constraint keeps. A path is dropped when it carries less than epsilon Qlow / (paths
 * of the beam), epsilon being EchoSettings::lightEnergyFraction, and not traced when an upper bound
 * shows that. All secondary paths of a beam are skipped when their bounds, with what is already
 * dropped, sum to less than epsilon Qlow. A beam whose energy would not be perceived even if all of
 * it (of an integrated beam: the most of a unit), by upper bounds, arrived in one range unit ends
 * before anything is traced on from its samples (only with the constraint on, and where noise
 * cannot matter). Of an integrated beam the direct echoes are those of its nodes
 * (PolygonQuadrature.h), and connections start from rays placed on its polygons, if they face each
 * other. Of a beam in cells they are those of its strips (RangeStrips.h), and connections start
 * from its rays. Mirror paths of both are those of MirrorRegions.h.
 *
 * Source: paper, Eq. 4-9 and Sec. 3.4.
 * Differs: the constraint compares with the sum of a range unit, not with a single ray: Qlow for a
 * ray would remove every wall.
 * Valid: no range unit loses more than epsilon Qlow; a beam that ends early has no echo
 * either way, unless paths that start from random rays bring more than the bound by chance.
 * Test: TestEchoClosedForms.cxx, TestSecondaryConstraints.cxx, TestScanAgain.cxx.
 */
#ifndef avianlidar_BeamLighting_h
#define avianlidar_BeamLighting_h

#include "BeamAir.h"
#include "BeamTrace.h"
#include "PolygonQuadrature.h"
#include "RangeUnits.h"
#include "Receiver.h"
#include "ScanBlock.h"
#include "SecondaryReflection.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// Lights one beam after the other. One per thread; the constructor's arguments must outlive it.
class BeamLighting
{
public:
  /// @param wanted called every 4096 steps within a beam; if it returns false, WorkStopped
  /// is thrown
  BeamLighting(const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams,
    ScanBlock& block, BeamSampler& sampler, const BeamReceiver& receiver, BeamAir& air,
    std::function<bool()> wanted);

  /// Light beams also where bounds show that nothing of them can be perceived.
  void lightAll() { this->LightsAll = true; }

  /// Light the samples of a beam of the block, if it has any, and add to `trace` what is found.
  /// @return false if nothing of the beam can be perceived; units and paths are incomplete then
  bool light(std::size_t beam, BeamTrace& trace);

  // Results for the beam lit last.
  const BeamSamples* samples() const { return this->Lit; } ///< null if it has none
  RangeUnitAccumulator& units() { return this->Units; }
  /// Energies of the direct echoes of the samples, J; empty if nothing can be perceived.
  const std::vector<double>& energies() const { return this->Energies; }
  const std::vector<SecondaryPath>& paths() const { return this->Paths; }
  /// Standard error, J, of the energy in a range unit: of the rays (StandardError.h), or of the
  /// cells and of the rays from which paths start. The direct echo of an integrated beam has a
  /// bound of the error instead, to which the standard error of its paths is added.
  /// The width of mirrors' lobes adds to it, where an aperture gathers their light.
  /// @param paths number of paths with a share in the unit
  double errorOf(std::int64_t unit, std::uint32_t paths);
  /// True if a direct echo arrives outside the gate, and nothing inside.
  bool isOutsideGate() const;
  /// The air along it.
  BeamAir& air() { return this->Air; }
  /// Radiance that the beam looks at, W/(m2 sr nm) (Background.h).
  double radiance() const { return this->Radiance; }
  double lost() const { return this->Lost; }              ///< J, see BeamReport
  std::uint32_t skipped() const { return this->Skipped; } ///< see BeamReport

private:
  bool placeSamples(std::size_t beam, BeamTrace& trace);
  bool placeNodes(std::size_t beam);
  bool raysAreLit() const { return this->Lit == this->Starts; }
  bool mayBePerceived(double most, double ofPaths);
  bool mayBeLeftOut(double farthest, double nearest) const;
  bool isSkipped(double most, double farthest, double nearest);
  void startFrom(const BeamSamples& rays);
  bool reflectAgain(std::size_t beam, BeamTrace& trace, double most);
  bool collectPaths(std::size_t beam, BeamTrace& trace);
  void dropFaintPaths();
  double passMedia(double sum);
  void fillUnits();
  double errorOfSamples(const RangeShares& shares, std::uint32_t paths);
  double errorOfLobes(const RangeShares& shares) const;
  double errorOfMirrors(const RangeShares& shares) const;
  double errorOfRays(const RangeShares& shares, bool filled);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const ScanBeams& Beams;
  ScanBlock& Block;
  BeamSampler& Sampler;
  const BeamReceiver& Receiver;
  std::function<bool()> Wanted;
  SecondaryReflection Secondary;
  PolygonQuadrature Quadrature;
  RangeUnitAccumulator Units;
  BeamAir& Air;
  bool LightsAll = false;

  // The beam being lit.
  const BeamSamples* Lit = nullptr;    ///< samples of the direct echo
  const BeamSamples* Starts = nullptr; ///< rays from which paths start; null if none do
  // Where no path starts from a ray.
  const BeamSamples NoStarts;
  const BeamRays NoRays;
  const SampleGeometry NoGeometry;
  const CellSamples* Cells = nullptr; ///< of a beam in cells
  /// What it sees, for mirror paths by regions, with hidden parts if it is in cells; null: they
  /// start from the rays.
  const VisiblePolygons* Surfaces = nullptr;
  bool Facing = false;          ///< an integrated beam may have paths over two reflections
  Throughput OfLit;             ///< direct echoes of `Lit`
  Throughput OfStarts;          ///< of `Starts`, if those are not what is lit
  std::vector<double> Energies; ///< energies of the direct echoes, J
  std::vector<SecondaryPath> Paths;
  double Direct = 0.0;   ///< J, sum of these before any is dropped
  double Unplaced = 0.0; ///< J, see PolygonQuadrature::dropped()
  double Radiance = 0.0;
  double Lost = 0.0;
  std::uint32_t Skipped = 0;
};
}

#endif
