// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamLighting.h
 * @brief Second stage of a beam: the energies of all its paths, in range units, and how far limits
 * and air may change before its echoes do.
 *
 * Direct echo of every hit (paper, Eq. 4-9); paths over two reflections; the light-energy
 * constraint.
 *
 * A beam all of whose energy, by upper bounds, would not be perceived if it arrived in one range
 * unit is done before anything is traced on from its hits: it has no echo (where noise does not
 * matter, and with the light-energy constraint, which is the switch for such savings).
 *
 * Light-energy constraint: a path is dropped when it carries less than epsilon Qlow / (paths of the
 * beam), epsilon = 1e-3, and not even traced when a bound says so. All secondary paths of a beam
 * are skipped when their bounds, with those already dropped, sum to less than epsilon Qlow. No
 * range unit so loses more than epsilon Qlow.
 *
 * A beam that a plane fills is integrated (PlaneQuadrature.h): its nodes are lit as hits with
 * shares of their own, and it has no other paths.
 */
#ifndef avianlidar_BeamLighting_h
#define avianlidar_BeamLighting_h

#include "BeamOutcome.h"
#include "DirectLight.h"
#include "PlaneQuadrature.h"
#include "RangeUnits.h"
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
  /// @param shading the setup's: strengths of others are not used @param receiver that will hear
  /// the beams @param wanted asked now and then within a beam of very many rays; false ends it with
  /// WorkStopped
  BeamLighting(const ScanSetup& setup, const ScanBeams& beams, const ShadingChange& shading,
    ScanBlock& block, BeamSamplers& samplers, const BeamReceiver& receiver,
    std::function<bool()> wanted);

  /// Light the hits of a beam of the block, if it has any. What is known of it is added to.
  /// @return false if nothing of it can be perceived; units and paths are not complete then
  bool light(std::size_t beam, BeamTrace& trace);

  /// After the receiver heard the beam lit last: how far its echoes hold.
  void conclude(const BeamTrace& trace);

  /// True if the echoes of a beam lit before are what they were: nothing was repainted that it
  /// meets, and limits and air leave them.
  bool isLit(BeamTrace& trace, const BeamOutcome& outcome) const;

  // Of the beam lit last.
  const PrimaryHits* hits() const { return this->Lit; } ///< null without any; nodes if integrated
  bool isIntegrated() const { return this->Integrated; }
  /// Rays of small targets, where hits have any.
  const TargetRays* targets() const { return this->Targets; }
  /// Bound of the error, J, of what an integrated beam put into some units.
  double boundOf(const RangeShares& shares) const
  {
    return this->Quadrature.boundOf(shares, this->Light.energy, this->Most);
  }
  RangeUnitAccumulator& units() { return this->Units; }
  const std::vector<SecondaryPath>& paths() const { return this->Paths; }
  const std::vector<double>& directEnergies() const { return this->Light.energy; } ///< J, of hits
  const BeamOutcome& outcome() const { return this->Outcome; } ///< without meaning with noise
  double hiddenGlint() const { return this->Glint; }           ///< J, see UnseenEnergy
  double lost() const { return this->Lost; }                   ///< J, see BeamReport
  std::uint32_t skipped() const { return this->Skipped; }      ///< see BeamReport

private:
  bool isRepainted(BeamTrace& trace) const;
  PathStrengths& strengthsOf(std::size_t beam, BeamTrace& trace);
  bool lightHits(std::size_t beam, BeamTrace& trace);
  bool lightPatch(std::size_t beam, VisiblePatch& patch);
  bool mayBePerceived(const SecondaryBeam& paths, double most);
  bool isSkipped(double farthest, double nearest);
  void reflectAgain(std::size_t beam, const SecondaryBeam& paths, double most);
  bool isFaint(double farthest, double energy) const;
  void dropFaintPaths(const PrimaryHits& hits);
  void boundLimits(const PathStrengths& strengths, double most, double lostBefore);
  double surestEnergy(const PrimaryHits& hits, double nearest) const;

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const ShadingChange& Shades;
  const LimitsAndAir Now;
  ScanBlock& Block;
  BeamSamplers& Samplers;
  const BeamReceiver& Receiver;
  std::function<bool()> Wanted;
  DirectLight Light;
  SecondaryReflection Secondary;
  PlaneQuadrature Quadrature;
  RangeUnitAccumulator Units;

  // The beam being lit.
  const PrimaryHits* Lit = nullptr;
  const TargetRays* Targets = nullptr;
  bool Integrated = false;
  double Nearest = 0.0; ///< m
  double Most = 0.0;    ///< J, of an integrated beam at most
  std::vector<SecondaryPath> Paths;
  BeamOutcome Outcome;
  double Glint = 0.0; ///< J
  double Lost = 0.0;
  std::uint32_t Skipped = 0;
};
}

#endif
