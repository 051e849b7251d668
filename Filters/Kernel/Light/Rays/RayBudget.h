// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayBudget.h
 * @brief How many rays a beam needs, from a pilot: for a target error, or to tell whether it has an
 * echo at all.
 *
 * The pilot's rays hit something; from their direct echoes follow, for every range unit that may be
 * the strongest of a return, its energy E and the standard error s that as many rays as the pilot's
 * P leave (StandardError.h).
 *
 * For a target error allowed is
 *
 * - e max(E, 2 Qlow), since echoes below 2 Qlow read high by selection, which more rays do not
 * mend;
 * - for a unit below Qlow no less than (Qlow - E)/2: it only has to stay unperceived by two
 * standard errors.
 *
 * Near Qlow (EchoSettings::refineNearLimit) the beam's N rays are the pilot. The beam keeps
 * them where |E - Qlow| >= 2 s. Otherwise allowed is |E - Qlow|/3, at least Qlow/60.
 * Units between two perceived ones count, too: they part returns.
 *
 * With n rays the error is s (P/n)^a: a = 1/2 for Monte Carlo; for strata 3/4 where edges cross the
 * beam, since an edge of length L meets of the order of L sqrt(n) of them, and 1 where one plane
 * fills the beam (all differences within a stratum shrink with its width). A lobe too narrow to
 * have been met goes with 1/2 whatever the sampling. So n = P (s/allowed)^(1/a), the largest of all
 * units.
 *
 * A small target (SmallTargets.h) has a pilot of its own, of as many rays (near Qlow: its
 * RaysOfTarget), and needs rays by the same reckoning, with strata: at its outline they are two to
 * a cell as the beam's are. Where its rays and others put energy into one unit, each of these k
 * parts is allowed 1/sqrt(k).
 *
 * With a target error the pilot decides n and is then discarded: stopping when an estimate looks
 * good would be biased (-72 % at a covered share of 0.02). Near Qlow a pilot that is sure is kept,
 * which biases the energy of echoes near Qlow where few rays see the object. What arrives over two
 * reflections is not in it.
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
/// One per thread. Setup and samplers must outlive it.
class RayBudget
{
public:
  RayBudget(const ScanSetup& setup, BeamSamplers& samplers);

  /// Rays for the beam of this pilot, from MinimumTargetRays (near Qlow: raysPerBeam) to
  /// mostRaysOfABeam() in steps of 19 %, so that the number of different partitions stays small.
  /// @param ofTargets gets the rays, an even number, of each target that the pilot has rays for:
  /// RaysOfTarget ... MostRaysOfTarget
  std::uint32_t raysFor(const BeamSamples& pilot, TargetRays& ofTargets);

private:
  void addUnits(const BeamSamples& pilot);
  bool isSure(double energy) const;
  void addUnit(const BeamSamples& pilot, const RangeUnit& unit, double glint);
  double allowedError(double energy, double error) const;
  double raysForTheUnseen(double reflectance) const;

  const ScanSetup& Setup;
  Throughput Light;             ///< of the pilot
  std::vector<double> Energies; ///< J, of its direct echoes
  RangeUnitAccumulator Units;
  RayError Error;
  double Wanted = 0.0;                 ///< rays, by the units looked at
  TargetRays OfPilot;                  ///< rays that the pilot has for each small target
  double LargestOfPilot = 0.0;         ///< J, of a ray; infinite where no bound is known
  std::vector<double> WantedOfTargets; ///< rays
};
}

#endif
