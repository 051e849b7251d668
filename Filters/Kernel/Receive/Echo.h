// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Echo.h
 * @brief One return of one beam, as the lidar reports it.
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
/// Object id of echoes from the air.
constexpr int ObjectOfAir = -2;

/// What a beam reports.
enum class BeamStatus
{
  Echo = 0,
  NoSurface = 1,
  BelowLimit = 2,
  Saturated = 3,
  OutsideGate = 4 ///< surfaces are met, all of them outside the range gate
};

// Echoes are compared as bytes, so padding is an error.
#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wpadded"
struct Echo
{
  double range = 0.0;          ///< range on the beam's axis, m
  double energyReceived = 0.0; ///< Qrec of the strongest range unit (Eq. 10), J
  double energy = 0.0;         ///< Qen of the strongest range unit (Eq. 12), J
  double returnEnergy = 0.0;   ///< sum of Qrec over the return, J
  double energyStdError = 0.0; ///< standard error of energyReceived, J; NaN with fewer than 8 rays
  int returnNumber = 1;        ///< number of the return in the beam, from 1
  int numberOfReturns = 1;     ///< number of returns of the beam
  int objectId = -1;           ///< object with the most energy; -1: false alarm, -2: air
  int materialId = -1;         ///< material with the most energy; -1: false alarm or medium
  double labelShare = 0.0;     ///< share of the energy from objectId and materialId
  /// Energy-weighted mean angle of incidence at the last surface, rad; NaN for a false alarm.
  double incidenceAngle = 0.0;
  double background = 0.0;     ///< spectral radiance in the beam, W/(m2 sr nm)
  double secondaryShare = 0.0; ///< share of the energy from paths with two reflections
};
#pragma GCC diagnostic pop
}

#endif
