// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayBudget.h
 * @brief The number of rays that a beam needs, from a pilot: for a target error, or to decide
 * whether it has an echo at all.
 *
 * The direct echoes of the pilot's P rays give, for every range unit that may be the strongest of a
 * return, its energy E and standard error s (StandardError.h). With a target error e, the allowed
 * error of a unit is
 *
 * - e max(E, 2 Qlow), since echoes below 2 Qlow read high by selection, which more rays do not
 * mend;
 * - at least (Qlow - E)/2 for a unit below Qlow: it only has to stay unperceived by two standard
 * errors.
 *
 * Near Qlow (EchoSettings::refineNearLimit) the beam's N rays are the pilot. The beam keeps them
 * where |E - Qlow| >= 2 s. Otherwise the allowed error is |E - Qlow|/3, at least Qlow/60. Units
 * between two perceived ones count, too, as they separate returns.
 *
 * With n rays the error is s (P/n)^a: a = 1/2 for Monte Carlo; for strata 3/4 where edges cross the
 * beam, since an edge of length L meets of the order of L sqrt(n) strata, and 1 where one plane
 * fills the beam (all differences within a stratum shrink with its width). A lobe too narrow to
 * have been hit goes with 1/2 for any sampling. So n = P (s/allowed)^(1/a), the largest of all
 * units.
 *
 * A small target (SmallTargets.h) has a pilot of its own, of as many rays (near Qlow: its
 * RaysOfTarget), and needs rays by the same rule, with strata: at its outline they are two to a
 * cell as the beam's are. Where its rays and others put energy into one unit, each of these k parts
 * is allowed 1/sqrt(k).
 *
 * Source: none.
 * Valid: with a target error the pilot decides n and is discarded, as stopping when an estimate
 * looks good would be biased (-72 % at a covered share of 0.02). Near Qlow a pilot whose decision
 * is certain is kept, which biases the energy of echoes near Qlow where few rays hit the object.
 * Paths over two reflections are not considered.
 * Test: TestRayBudget.cxx, TestTargetsAndOthers.cxx, TestSmallTargets.cxx.
 */
#ifndef avianlidar_RayBudget_h
#define avianlidar_RayBudget_h

#include "BeamSamplers.h"
#include "RangeUnits.h"
#include "RayError.h"
#include "ScanSetup.h"
#include "SecondaryReflection.h"
#include "SmallTargets.h"
#include "Throughput.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Ray numbers of one beam after the other. One per thread; setup and samplers must outlive it.
class RayBudget
{
public:
  RayBudget(const ScanSetup& setup, BeamSamplers& samplers);

  /// Number of rays for the beam of this pilot, from MinimumTargetRays (near Qlow: raysPerBeam) to
  /// mostRaysOfABeam() in steps of 19 %, so that there are few different partitions.
  /// @param ofTargets out: number of rays of each target that the pilot has rays for, even, from
  /// RaysOfTarget to MostRaysOfTarget
  std::uint32_t raysFor(const BeamSamples& pilot, TargetRays& ofTargets);

private:
  void addUnits(const BeamSamples& pilot);
  bool isSure(double energy) const;
  void addUnit(const BeamSamples& pilot, const RangeUnit& unit, double glint);
  double allowedError(double energy, double error) const;
  double raysForTheUnseen(double reflectance) const;

  const ScanSetup& Setup;
  Throughput Light;             ///< throughput of the pilot
  std::vector<double> Energies; ///< energies of its direct echoes, J
  RangeUnitAccumulator Units;
  RayError Error;
  double Wanted = 0.0;                 ///< rays needed by the units so far
  TargetRays OfPilot;                  ///< rays of each small target in the pilot
  double LargestOfPilot = 0.0;         ///< largest energy of a ray, J; infinite if not bounded
  std::vector<double> WantedOfTargets; ///< rays needed by each target
};
}

#endif
