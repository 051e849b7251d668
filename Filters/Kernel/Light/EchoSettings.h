// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EchoSettings.h
 * @brief Atmosphere and fidelity of a simulation: everything that belongs neither to the sensor nor
 * to the surfaces.
 */
#ifndef avianlidar_EchoSettings_h
#define avianlidar_EchoSettings_h

#include "BeamRays.h"
#include "BeamTracer.h"
#include "Receiver.h"
#include "Reflectance.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace avianlidar
{
/// Share of Qlow that the light-energy constraint may cost a range unit at most.
constexpr double LightEnergyTolerance = 1e-3;

/// Rays of the pilot that estimates what a beam needs when a target error is set.
constexpr int PilotRays = 32;

/// With a target error a beam gets at least this many rays, and at most MaximumRayFactor times
/// raysPerBeam.
constexpr int MinimumTargetRays = 8;
constexpr int MaximumRayFactor = 16;

/// A beam near Qlow gets at most MaximumRayFactor times raysPerBeam rays, and not more than this.
constexpr int MostRaysNearLimit = 10000;

/// Beams of fewer rays are sampled: an integral would take longer.
constexpr int FewestRaysIntegrated = 32;

/// Most paths of one beam (mostPathsOfABeam()): bounds the work between two looks at the wish to
/// abort, and memory.
constexpr double MaximumPathsPerBeam = 1e8;

/// Most range units that the paths of one beam may meet: bounds memory (about 60 bytes each).
constexpr double MaximumUnitsPerBeam = 1e8;

/// 1/m, far beyond any air: attenuation times length stays a number.
constexpr double MaximumAttenuation = 1e30;

/// Small objects with rays of their own (SmallTargets.h): rays of each, with a target error at most
/// so many, and objects of one beam at most, those of the largest solid angles.
constexpr std::uint32_t RaysOfTarget = 8;
constexpr std::uint32_t MostRaysOfTarget = 4096;
constexpr std::size_t MaximumTargets = 16;

struct EchoSettings
{
  int raysPerBeam = 100; ///< N, 1 ... 1e6
  Sampling sampling = Sampling::Stratified;
  double targetRelativeError = 0.0; ///< of every echo's received energy; 0: off, N rays a beam
  std::int32_t seed = 0;
  double attenuationCoefficient = 3.5e-5; ///< mu, 1/m, 0 to 1e30
  ReflectanceModel reflectanceModel = ReflectanceModel::LambertBlinnPhong;
  int numberOfReflections = 2; ///< 1 or 2
  bool beamConstraint = true;
  bool lightEnergyConstraint = true;
  TraceMode traceMode = TraceMode::Automatic; ///< no number of the echoes depends on it
  bool noise = true;
  bool smallTargets = true; ///< rays of their own for objects small against the spacing of rays
  bool fullModel = false;   ///< nothing is left out that cannot matter
  ReturnMode returnMode = ReturnMode::All;
  int numberOfConnections = 2;  ///< M, 0 ... N-1 (larger values mean N-1)
  bool planeIntegration = true; ///< beams that planes fill are integrated, not sampled
  bool refineNearLimit = true;  ///< more rays where N leave open whether an echo exceeds Qlow
};

/// True if beams that planes fill are integrated.
bool integratesPlanes(const EchoSettings& settings);

/// True if beams near Qlow may get more rays than the others. A target error looks after them.
bool refinesNearLimit(const EchoSettings& settings);

/// Rays that a beam may have at most, but for those of small targets.
std::uint32_t mostRaysOfABeam(const EchoSettings& settings);

/// Rays that a small target may have at most.
std::uint32_t mostRaysOfATarget(const EchoSettings& settings);

/// Empty if the settings are usable; otherwise a sentence that names the value and what was
/// expected.
std::string checkSettings(const EchoSettings& settings);

/// Paths that a beam may have at most, N (2 + M), and two of every ray of small targets.
double mostPathsOfABeam(const EchoSettings& settings);

/// Empty if no beam can meet more than MaximumUnitsPerBeam range units; otherwise a sentence that
/// names pulse width and rays, and what was expected. Both must have passed their own checks.
std::string checkUnits(const Sensor& sensor, const EchoSettings& settings);

enum class EchoPreset
{
  Custom = 0,   ///< the settings as they are
  Draft = 1,    ///< a fast look
  Standard = 2, ///< what most want
  Reference = 3 ///< converged: what others are compared with
};

/// Replaces what makes a simulation fast or accurate, and nothing else: number of rays, sampling,
/// target error, refinement near Qlow, reflections, connections. Empty if the preset is one of the
/// four; otherwise a sentence that names the value and what was expected, and the settings stay.
std::string applyPreset(EchoPreset preset, EchoSettings& settings);
}

#endif
