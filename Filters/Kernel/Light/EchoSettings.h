// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EchoSettings.h
 * @brief Atmosphere and fidelity of a simulation: all settings that belong neither to the sensor
 * nor to the surfaces, their limits, and their presets.
 *
 * Source: none; the presets follow from the measured trade of time for accuracy
 * (Documentation/results/accuracy.md).
 * Valid: checkSettings() and checkUnits() name values out of range.
 * Test: TestEchoPreset.cxx, TestScanReport.cxx.
 */
#ifndef avianlidar_EchoSettings_h
#define avianlidar_EchoSettings_h

#include "BeamRays.h"
#include "BeamTracer.h"
#include "Reflectance.h"
#include "Sensor.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Which returns of a beam become points.
enum class ReturnMode
{
  All = 0,
  Strongest = 1, ///< largest energy of the strongest unit; ties to the nearest
  First = 2,
  Last = 3,
  RangeUnits = 4 ///< the paper's literal reading: one point per perceived range unit, at its centre
};

/// Largest EchoSettings::lightEnergyFraction: as many paths as a beam may have.
constexpr double MaximumLightEnergyFraction = 1e8;

/// Most triangles that an integrated beam may meet: N/50, but no fewer and no more than these.
/// Beyond, cells take less time for the same error.
constexpr double FewTriangles = 100.0;
constexpr double ManyTriangles = 200.0;
constexpr double TrianglesPerRay = 1.0 / 50.0;

/// Rays of the grid of a beam in cells (BeamCells.h), for each of its N rays, as far as densities
/// come in steps.
constexpr double CellRaysPerRay = 32.0;

/// The grid of a beam in cells: of the cells of the last level each holds 16 m^2 rays. m is at most
/// MostBlocksAcross, which are a million rays: memory of a beam, and the time until an abort is
/// heard.
struct CellDensity
{
  static constexpr int MostBlocksAcross = 18;
  int levels;          ///< of division
  int blocks;          ///< m
  double rays() const; ///< in the disc
  /// Rays that are to fall on a small object: OnObject, which err by 1.5 % rms of a bird's
  /// area, by more than 5 % in 1 of 300 (TestBird.cxx), or a 25th of a grid of one level, but 16.
  double raysOnObject() const;
  static constexpr double OnObject = 256.0;
};
CellDensity densityOfCells(int raysPerBeam);

/// Of N, for each ray from which connections start, and the least number of those.
constexpr int RaysPerStart = 4;
constexpr int LeastStarts = 16;

/// Most paths of one beam (pathsOfABeam()): bounds memory, and the work between two checks for
/// an abort.
constexpr double MaximumPathsPerBeam = 1e8;

/// Most range units that the paths of one beam may meet: bounds memory (about 60 bytes each).
constexpr double MaximumUnitsPerBeam = 1e8;

/// 1/m, far beyond any air: attenuation times length stays a number.
constexpr double MaximumAttenuation = 1e30;

/// How the direct echo of a beam is found.
enum class BeamSampleSource
{
  Cells = 0, ///< over the polygons that it sees, or by a dense grid of rays where they are many
  Rays = 1   ///< by its N rays (paper, Algorithm 2)
};

/// What the light-energy constraint compares a path with.
enum class LightEnergyThreshold
{
  ShareOfLimit = 0, ///< lightEnergyFraction of Qlow over the paths of the beam
  Limit = 1         ///< Qlow, of paths over two reflections alone (paper, Sec. 3.4)
};

struct EchoSettings
{
  BeamSampleSource beamSamples = BeamSampleSource::Cells;
  int raysPerBeam = 100;                    ///< N, 1 ... 1e6
  Sampling sampling = Sampling::Stratified; ///< of rays; in cells, connections start from them
  std::int32_t seed = 0;
  double attenuationCoefficient = 3.5e-5; ///< mu, 1/m, 0 to 1e30
  ReflectanceModel reflectanceModel = ReflectanceModel::LambertBlinnPhong;
  int numberOfReflections = 2; ///< 1 or 2
  bool beamConstraint = true;
  bool lightEnergyConstraint = true;
  /// epsilon of the light-energy constraint: share of Qlow that a range unit may lose by it, 0 to
  /// 1e8; the number of a beam's paths compares each of them with Qlow
  double lightEnergyFraction = 1e-3;
  LightEnergyThreshold lightEnergyThreshold = LightEnergyThreshold::ShareOfLimit;
  TraceMode traceMode = TraceMode::Automatic; ///< affects time only, not echoes
  bool noise = true;
  bool fullModel = false; ///< model parts that cannot matter are not left out
  ReturnMode returnMode = ReturnMode::All;
  int numberOfConnections = 2; ///< M, at least 0, see connectionsOf()
};

/// A setting, for all that goes through them: checks, keys, field data, agreement of ranks.
struct EchoSetting
{
  const char* property; ///< of vtkAvianLidarScanFilter
  const char* name;     ///< as field data have it
  const char* unit;     ///< "1": a pure number; "": no quantity
  bool whole;
  bool decides; ///< changes echoes
  double least, most;
  const char* expected; ///< the range in words
  double (*get)(const EchoSettings&);
  void (*set)(EchoSettings&, double);
};

/// All settings.
const std::vector<EchoSetting>& echoSettings();

/// Most triangles that an integrated beam may meet; 0: none is integrated.
std::size_t mostTrianglesIntegrated(const EchoSettings& settings);

/// Empty if the settings are usable; otherwise a sentence that names the value and what was
/// expected.
std::string checkSettings(const EchoSettings& settings);

/// Rays that are traced for a beam: N with BeamSampleSource::Rays, else those from which
/// connections start (SecondaryReflection.h), one for each RaysPerStart of N.
std::uint32_t tracedRaysOf(const EchoSettings& settings);

/// Connections of each of these rays: M, as far as there are others, or none where one reflection
/// is asked for.
std::uint32_t connectionsOf(const EchoSettings& settings);

/// Paths of a beam, of one and two reflections, all counted: N (2 + M).
double pathsOfABeam(const EchoSettings& settings);

/// Empty if no beam can meet more than MaximumUnitsPerBeam range units; otherwise a sentence that
/// names pulse width and rays, and what was expected. Both must have passed their own checks.
std::string checkUnits(const Sensor& sensor, const EchoSettings& settings);

/// Named settings of fidelity.
enum class EchoPreset
{
  Custom = 0,   ///< the settings as they are
  Draft = 1,    ///< a fast look
  Standard = 2, ///< for most uses
  Reference = 3 ///< converged: others are compared with it
};

/// Replace the settings that make a simulation fast or accurate, and no others: number of rays,
/// sampling, reflections, connections. Empty if the preset is one of the four; otherwise a sentence
/// that names the value and what was expected, and the settings do not change.
std::string applyPreset(EchoPreset preset, EchoSettings& settings);
}

#endif
