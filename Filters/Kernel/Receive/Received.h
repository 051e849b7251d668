// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Received.h
 * @brief What the receiver makes of the light in one beam: range units with noise, and returns.
 *
 * Source: paper, Eq. 10-12.
 * Differs: see BeamReceiver.h.
 * Valid: see BeamReceiver.h.
 * Test: TestReceiver.cxx.
 */
#ifndef avianlidar_Received_h
#define avianlidar_Received_h

#include "BeamNoise.h"
#include "RangeErrors.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace avianlidar
{
/// A range unit with its noise.
struct ReceivedUnit
{
  std::int64_t index = 0;  ///< number m of the range unit
  double energy = 0.0;     ///< energy Qrec, noise included, J
  double noise = 0.0;      ///< energy Qn of the noise, J
  std::uint32_t paths = 0; ///< number of paths with a share; 0: a false alarm, or only air
  double air = 0.0;        ///< part of `energy` from air that a threshold may follow, J
  double leaves = 0.0;     ///< part of `energy` from media that no threshold follows, J
  int medium = -1;         ///< object id of the medium with the largest part of `leaves`
  double lower = 0.0;      ///< lower limit of this unit, J
  double upper = 0.0;      ///< upper limit of this unit, J
};

struct Return
{
  std::size_t firstUnit = 0; ///< units [firstUnit, lastUnit) of Received::units
  std::size_t lastUnit = 0;
  std::size_t strongestUnit = 0; ///< nearest unit with the largest Qrec
  double energyReceived = 0.0;   ///< Qrec of the strongest unit (Eq. 10), J
  double energy = 0.0;           ///< Qen of the strongest unit (Eq. 12), J
  double returnEnergy = 0.0;     ///< sum of Qrec over the run, J
  bool hasLight = false;         ///< whether light of paths arrived; false: only noise or air
  double air = 0.0;              ///< sum of ReceivedUnit::air, J
  double leaves = 0.0;           ///< sum of ReceivedUnit::leaves, J
  int medium = -1;               ///< ReceivedUnit::medium of the unit with most `leaves`
  double rangeOfLeaves = 0.0;    ///< mean range of the light in `leaves`, m
  double range = 0.0;            ///< range of a return without light, m (ReturnRanges.h)
  RangeError error;              ///< error of the reported range
  // returnNumber and numberOfReturns count all returns of the beam, before ReturnMode selects.
  int returnNumber = 1;    ///< number of the return, from 1, nearest first
  int numberOfReturns = 1; ///< number of returns of the beam
};

/// What the receiver makes of the light in one beam.
struct Received
{
  NoiseKey key;    ///< key of the beam's random numbers
  double radiance; ///< spectral radiance in the beam, W/(m2 sr nm)
  /// Units with light or false alarms, ascending, perceived or not. A unit that is perceived only
  /// with rare noise is left out unless it has rare noise.
  std::vector<ReceivedUnit> units;
  std::vector<Return> returns;     ///< the returns that the mode selects, nearest first
  std::optional<Return> strongest; ///< the strongest return of the beam, in every mode
};
}

#endif
