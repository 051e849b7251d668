// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PulseLanes.h
 * @brief Where the pulses of all paths of a beam lie among its range units, and what they put there
 * (RangeUnits.h), in loops over lanes.
 *
 * Begins and widths of pulses are in units; first and last are the units that a pulse overlaps.
 */
#ifndef avianlidar_PulseLanes_h
#define avianlidar_PulseLanes_h

#include "Multiversion.h"

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// The pulses of a beam.
struct PulseLanes
{
  const double* energies; ///< J
  const double* begins;
  const double* widths;
  const double* firsts;
  const double* lasts;
  std::size_t count;
};

/// What the pulses of a beam that have energy have in common.
struct PulseExtent
{
  double lowest;  ///< unit
  double highest; ///< unit; below the lowest where there is no energy
  double units;   ///< most that one pulse overlaps, less one
};

/// Place `count` pulses by the lengths of their paths. @param unitPathLength m @param relativeWidth
/// of a pulse, in units
PulseExtent placePulses(const double* lengths, const double* energies, double unitPathLength,
  double relativeWidth, double* begins, double* widths, double* firsts, double* lasts,
  std::size_t count);

/// Of pulses that meet two units at most: the first, counted from the lowest and at most `window`,
/// and what this one and the next get.
void halvePulses(const PulseLanes& pulses, double lowest, double window, std::uint32_t* places,
  double* here, double* next);

/// Energy of a pulse inside units [first, last).
AVIANLIDAR_ALWAYS_INLINE double portionOfPulse(double energy, double begin, double width,
  double pulseFirst, double pulseLast, double first, double last)
{
  const double from = pulseFirst >= first ? 0.0 : (first - begin) / width;
  const double to = pulseLast < last ? 1.0 : (last - begin) / width;
  const double portion = energy * (to - from);
  const bool meets = (pulseFirst < last) & (pulseLast >= first) & (portion > 0.0);
  return meets ? portion : 0.0;
}

/// Energies of all pulses inside units [first, last).
void portionsOfPulses(const PulseLanes& pulses, double first, double last, double* portions);

/// The same of pulses that were halved. @param first, last counted from the lowest
void portionsOfHalves(const double* energies, const std::uint32_t* places, const double* here,
  const double* next, double first, double last, double* portions, std::size_t count);
}

#endif
