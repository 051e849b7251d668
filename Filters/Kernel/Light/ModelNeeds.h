// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ModelNeeds.h
 * @brief What of the model a scan needs, from bounds that hold for all its beams, and what it
 * leaves out at most.
 *
 * From pulse energy, limits, air, aperture and the most that any surface of the scene returns
 * follows: whether paths over two reflections can matter at all, from which range on nothing can be
 * perceived, which small objects deserve rays of their own. What of single beams is left out stands
 * in their reports (SkippedPart); the energies are those of the light-energy constraint
 * (BeamLighting.h) and of the noise plan (Noise.h). `FullModel` leaves nothing out.
 *
 * Two things that might be left out are not. Attenuation costs the same exponential at any
 * coefficient. Surfaces beyond the perceivable range are hit as others are: hits do not depend on
 * limits and air, so that a scan can be lit again; and the report tells a beam that meets a surface
 * in vain from one that meets none.
 */
#ifndef avianlidar_ModelNeeds_h
#define avianlidar_ModelNeeds_h

#include <cstdint>

namespace avianlidar
{
/// Bounds are rounded differently from what they bound.
constexpr double SurelyAbove = 1.0 + 1e-9;
constexpr double SurelyBelow = 1.0 - 1e-9;

struct ScanSetup;
struct EchoSettings;
class ObjectSpheres;

/// Parts of the model that a beam did without; bits of BeamReport::skipped.
enum SkippedPart : std::uint32_t
{
  SkippedSecondaryPaths = 1, ///< some or all paths over two reflections
  SkippedBeam = 2,           ///< everything: all its energy together would not be perceived
  SkippedNoise = 4,          ///< photon noise, which cannot matter; set by who reports
  SkippedBeyondRange = 8,    ///< with SkippedBeam: all it meets lies beyond the perceivable range
  SkippedDirectPaths = 16    ///< some direct echoes
};

struct ModelNeeds
{
  /// m: from there on a surface that fills the beam, returning all that any surface of the scene
  /// can, is not perceived. Infinity where there is no such range.
  double perceivableRange = 0.0;
  bool secondaryReflections = false; ///< false: not asked for, or none can matter
  double secondaryBound = 0.0; ///< J: all paths over two reflections of a beam, if there are any
  /// J: what any range unit of a beam with an echo loses at most by all that is left out, and what
  /// skipped noise might have added.
  double skippedEnergyBound = 0.0;
  /// J: an object that returns more than this is missed by all rays of a beam with a probability
  /// below 5 %, unless it has rays of its own.
  double missedDetailEnergy = 0.0;
  /// Share of the beam's solid angle from which on a small object can bring a beam the tolerance
  /// of the light-energy constraint, rounded down to a power of 4, so that not every change of a
  /// limit gives other objects rays; infinity: none has rays of its own.
  double smallestTarget = 0.0;
};

/// @param setup all but its needs
ModelNeeds needsOf(const ScanSetup& setup);

/// True if paths that cannot matter are dropped.
bool dropsFaintPaths(const EchoSettings& settings);
}

#endif
