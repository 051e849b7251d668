// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamLighting.h
 * @brief Second stage of a beam: the energies of all its paths, in range units.
 *
 * Direct echo of every sample (paper, Eq. 4-9); paths over two reflections; the light-energy
 * constraint.
 *
 * A beam all of whose energy, by upper bounds, would not be perceived if it arrived in one range
 * unit is done before anything is traced on from its samples: it has no echo (where noise does not
 * matter, and with the light-energy constraint, which is the switch for such savings).
 *
 * Light-energy constraint: a path is dropped when it carries less than epsilon Qlow / (paths of the
 * beam), epsilon = 1e-3, and not even traced when a bound says so. All secondary paths of a beam
 * are skipped when their bounds, with those already dropped, sum to less than epsilon Qlow. No
 * range unit so loses more than epsilon Qlow.
 *
 * A beam that planes fill is integrated: its samples are nodes (PlaneQuadrature.h), and no paths go
 * on from them.
 */
#ifndef avianlidar_BeamLighting_h
#define avianlidar_BeamLighting_h

#include "BeamTrace.h"
#include "PlaneQuadrature.h"
#include "RangeUnits.h"
#include "RayError.h"
#include "Receiver.h"
#include "ScanBlock.h"
#include "SecondaryReflection.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// One per thread. What the constructor is given must outlive it.
class BeamLighting
{
public:
  /// @param shading number of the setup's: throughputs of others are not used @param receiver of
  /// the beams @param wanted asked now and then within a beam of very many rays; false ends it with
  /// WorkStopped
  BeamLighting(const ScanSetup& setup, const ScanBeams& beams, std::uint32_t shading,
    ScanBlock& block, BeamSamplers& samplers, const BeamReceiver& receiver,
    std::function<bool()> wanted);

  /// Light the samples of a beam of the block, if it has any. What is known of it is added to.
  /// @return false if nothing of it can be perceived; units and paths are not complete then
  bool light(std::size_t beam, BeamTrace& trace);

  // Of the beam lit last.
  const BeamSamples* samples() const { return this->Lit; } ///< null without any
  RangeUnitAccumulator& units() { return this->Units; }
  const std::vector<SecondaryPath>& paths() const { return this->Paths; }
  /// Standard error, or a bound of the error, of what arrived in a range unit, J. @param paths with
  /// a share in it
  double errorOf(std::int64_t unit, std::uint32_t paths);
  /// True if a direct echo arrives beyond the gate, and nothing inside.
  bool isBeyondGate() const;
  double lost() const { return this->Lost; }              ///< J, see BeamReport
  std::uint32_t skipped() const { return this->Skipped; } ///< see BeamReport

private:
  bool placeSamples(std::size_t beam, BeamTrace& trace);
  Throughput& throughputOf(std::size_t beam, BeamTrace& trace);
  bool mayBePerceived(const Throughput& throughput, double most);
  bool isSkipped(double most, double farthest, double nearest);
  void reflectAgain(std::size_t beam, BeamTrace& trace, Throughput& throughput, double most);
  void collectPaths(std::size_t beam, BeamTrace& trace, Throughput& throughput);
  void dropFaintPaths();
  void fillUnits();

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const std::uint32_t Shading;
  ScanBlock& Block;
  BeamSamplers& Samplers;
  const BeamReceiver& Receiver;
  std::function<bool()> Wanted;
  SecondaryReflection Secondary;
  PlaneQuadrature Quadrature;
  RayError Error;
  RangeUnitAccumulator Units;

  // The beam being lit.
  const BeamSamples* Lit = nullptr;
  const TargetRays* Targets = nullptr;
  bool Integrated = false;
  Throughput OfNodes;           ///< of an integrated beam
  std::vector<double> Energies; ///< J, of direct echoes
  std::vector<SecondaryPath> Paths;
  double Most = 0.0;  ///< J, of an integrated beam at most
  double Glint = 0.0; ///< J, see UnseenEnergy
  double Lost = 0.0;
  std::uint32_t Skipped = 0;
};
}

#endif
