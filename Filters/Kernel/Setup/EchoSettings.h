// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EchoSettings.h
 * @brief Atmosphere and fidelity of a simulation: all settings that belong neither to the sensor
 * nor to the surfaces, their limits, and their presets.
 *
 * Source: none. The presets follow from the measured trade of time for accuracy
 * (Documentation/evidence/accuracy.md).
 * Valid: checkSettings() and checkUnits() name values out of range.
 * Test: TestScanReport.cxx, TestPresets.py.
 */
#ifndef avianlidar_EchoSettings_h
#define avianlidar_EchoSettings_h

#include "BeamRays.h"
#include "Reflectance.h"
#include "Sensor.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Selection of the returns of a beam that become points.
enum class ReturnMode
{
  All = 0,
  Strongest = 1, ///< the return with the strongest range unit; the nearest of equal returns
  First = 2,
  Last = 3,
  RangeUnits = 4 ///< a point at the centre of each perceived range unit (paper, read literally)
};

/// Largest EchoSettings::lightEnergyFraction; equal to MaximumPathsPerBeam.
constexpr double MaximumLightEnergyFraction = 1e8;

/// A beam is integrated if the number of the beam's triangles is at most TrianglesPerRay times N,
/// clamped to the range from FewTriangles to ManyTriangles. With more triangles, cells take less
/// time than the integral for the same error.
constexpr double FewTriangles = 100.0;
constexpr double ManyTriangles = 200.0;
constexpr double TrianglesPerRay = 1.0 / 50.0;

/// Number of rays in the grid of a beam in cells (BeamCells.h), divided by N. The actual number
/// changes in steps (densityOfCells()).
constexpr double CellRaysPerRay = 32.0;

/// Grid of a beam in cells: each cell of the last level holds m x m blocks of 16 rays.
/// MostBlocksAcross limits the grid to a million rays, and so limits memory and the time until an
/// abort.
struct CellDensity
{
  static constexpr int MostBlocksAcross = 18;
  int levels;          ///< number of times that cells are divided
  int blocks;          ///< number m of blocks of rays across a cell
  double rays() const; ///< number of rays in the disc
  /// Least number of rays on a small object. With OnObject rays, the area of a bird has an error of
  /// 1.5 % rms. The error exceeds 5 % in one case of 300 (TestBird.cxx). With one level the least
  /// number is a 25th of the rays in the grid, but at least 16.
  double raysOnObject() const;
  static constexpr double OnObject = 256.0;
};
CellDensity densityOfCells(int raysPerBeam);

/// One ray in RaysPerStart starts connections, and at least LeastStarts rays do.
constexpr int RaysPerStart = 4;
constexpr int LeastStarts = 16;

/// Largest pathsOfABeam(), which bounds memory and the work between two checks for an abort.
constexpr double MaximumPathsPerBeam = 1e8;

/// Largest number of range units of a beam's paths, which bounds memory (about 60 bytes per range
/// unit).
constexpr double MaximumUnitsPerBeam = 1e8;

/// Largest attenuation coefficient, 1/m, far above the coefficient of any air. The limit keeps
/// optical depths finite.
constexpr double MaximumAttenuation = 1e30;

/// Method that finds the direct echo of a beam.
enum class BeamSampleSource
{
  Cells = 0, ///< integral over visible polygons, or a dense grid of rays for many polygons
  Rays = 1   ///< N rays (paper, Algorithm 2)
};

/// Energy below which the light-energy constraint drops a path.
enum class LightEnergyThreshold
{
  ShareOfLimit = 0, ///< lightEnergyFraction Qlow / (number of paths of the beam)
  Limit = 1,        ///< Qlow, only for paths with two reflections (paper, Sec. 3.4)
  LimitPerRay = 2   ///< Qlow / raysPerBeam, only for paths with two reflections
};

/// Way in which beams descend the tree. All modes give bitwise identical hits.
enum class TraceMode
{
  SingleRays = 0, ///< one descent per ray
  Automatic = 1,  ///< groups of neighbouring beams, then packets of their rays
  /// The paper's batch collision detection (Sec. 3.2): every beam descends to the triangles that
  /// its cone may meet, S_potential. All rays of the beam are then tested against S_potential.
  Beams = 2
};

struct EchoSettings
{
  BeamSampleSource beamSamples = BeamSampleSource::Cells;
  int raysPerBeam = 100;                    ///< number of rays of a beam, N, 1 to 1e6
  Sampling sampling = Sampling::Stratified; ///< sampling of rays, except rays in cells
  std::int32_t seed = 0;
  double attenuationCoefficient = 3.5e-5; ///< attenuation coefficient mu, 1/m, 0 to 1e30
  ReflectanceModel reflectanceModel = ReflectanceModel::LambertBlinnPhong;
  /// Largest number of reflections of a path, 1 to 3. The third is by the mirror of the first, and
  /// needs an aperture.
  int numberOfReflections = 3;
  bool beamConstraint = true;
  bool lightEnergyConstraint = true;
  /// epsilon of the light-energy constraint: share of Qlow that a range unit may lose, 0 to 1e8.
  double lightEnergyFraction = 1e-3;
  LightEnergyThreshold lightEnergyThreshold = LightEnergyThreshold::ShareOfLimit;
  TraceMode traceMode = TraceMode::Automatic; ///< descent of the tree; affects only time
  bool noise = true;
  bool fullModel = false; ///< whether parts of the model that cannot matter are computed, too
  ReturnMode returnMode = ReturnMode::All;
  int numberOfConnections = 2; ///< number M of connections of a ray, at least 0 (connectionsOf())
  bool waveforms = false;      ///< whether waveforms are recorded (BeamWaveforms.h)
  double waveformFloor = 0.1;  ///< mean signal above which waveforms are recorded, over Qlow, >= 0
};

/// Effect of a setting, apart from the time of a scan.
enum class SettingEffect
{
  None,
  Echoes,
  Rays ///< new rays and new echoes: kept beams are traced again
};

/// Description of a setting, for checks, keys, field data and the agreement of ranks.
struct EchoSetting
{
  const char* property; ///< name in vtkAvianLidarScanFilter
  const char* name;     ///< name in field data
  const char* unit;     ///< unit; "1": a pure number; "": not a quantity
  bool whole;
  SettingEffect effect;
  double least, most;
  const char* expected; ///< the allowed range in words
  double (*get)(const EchoSettings&);
  void (*set)(EchoSettings&, double);
};

const std::vector<EchoSetting>& echoSettings();

/// Largest number of triangles in an integrated beam; 0 if no beam is integrated.
std::size_t mostTrianglesIntegrated(const EchoSettings& settings);

/// Empty if the settings are usable; otherwise a sentence with the value and what was expected.
std::string checkSettings(const EchoSettings& settings);

/// Number of rays that are traced for a beam: N with BeamSampleSource::Rays, otherwise the number
/// of rays that start connections (SecondaryReflection.h).
std::uint32_t tracedRaysOf(const EchoSettings& settings);

/// Number of connections of each ray of tracedRaysOf(): M, but at most the number of these rays
/// minus one; 0 with one reflection.
std::uint32_t connectionsOf(const EchoSettings& settings);

/// Number of a beam's paths, with one or two reflections: N (2 + M).
double pathsOfABeam(const EchoSettings& settings);

/// Empty if no beam can meet more than MaximumUnitsPerBeam range units; otherwise a sentence that
/// names pulse width and rays, and what was expected. Arguments must have passed their own checks.
std::string checkUnits(const Sensor& sensor, const EchoSettings& settings);

/// Named settings of fidelity.
enum class EchoPreset
{
  Custom = 0,    ///< the settings as they are
  Draft = 1,     ///< settings for a first overview
  Standard = 2,  ///< settings for most uses
  Reference = 3, ///< converged settings, with which other presets are compared
  Paper = 4,     ///< the method of the paper: 100 rays, two constraints, a point per range unit
  Preview = 5    ///< the fastest settings: 100 rays and one reflection
};

/// Apply a preset to the settings of fidelity. The preset Paper also sets the settings that select
/// the method.
/// @return empty if the preset exists. Otherwise the settings do not change, and the result is a
/// sentence that names the value and what was expected.
std::string applyPreset(EchoPreset preset, EchoSettings& settings);
}

#endif
