// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Echo.h
 * @brief What a lidar puts out.
 *
 * Source: paper, Eq. 10 and 12.
 * Differs: returns, labels and standard errors are added (BeamEchoes.h).
 * Valid: see BeamEchoes.h.
 * Test: TestScanReport.cxx.
 */
#ifndef avianlidar_Echo_h
#define avianlidar_Echo_h

namespace avianlidar
{
/// Object of what the air returned.
constexpr int ObjectOfAir = -2;

// Echoes are compared as bytes: none may be without a member.
#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wpadded"
/// One return of one beam.
struct Echo
{
  double range = 0.0;          ///< m along the axis
  double energyReceived = 0.0; ///< J, Qrec of the strongest unit (Eq. 10)
  double energy = 0.0;         ///< J, Qen of the strongest unit (Eq. 12)
  double returnEnergy = 0.0;   ///< J, sum of Qrec over the return
  double energyStdError = 0.0; ///< J, of energyReceived; NaN below 8 rays
  int returnNumber = 1;
  int numberOfReturns = 1;
  int objectId = -1; ///< object of the largest share of the energy; -1 for a false alarm, -2: air
  int materialId = -1;
  double labelShare = 0.0; ///< the largest share
  double incidenceAngle =
    0.0;                   ///< rad, energy-weighted mean at the last surface; NaN for a false alarm
  double background = 0.0; ///< radiance that its beam looks at, W/(m2 sr nm)
  double secondaryShare = 0.0; ///< share of the energy that came over two reflections
};
#pragma GCC diagnostic pop
}

#endif
