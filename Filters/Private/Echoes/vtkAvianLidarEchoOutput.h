// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarEchoOutput.h
 * @brief Turns the kernel's echoes and beam report into vtkPolyData, and writes the settings of the
 * scan as field data. Not installed.
 */
#ifndef vtkAvianLidarEchoOutput_h
#define vtkAvianLidarEchoOutput_h

#include "MoverReport.h"
#include "Scan.h"
#include "vtkAvianLidarBeams.h"
#include "vtkAvianLidarMovers.h"

class vtkFieldData;
class vtkPolyData;

namespace vtkAvianLidarEchoOutput
{
/// Fill in one vertex per return, with all arrays. @param noise noise plan of the scan
void FillEchoes(const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams,
  const avianlidar::NoisePlan& noise, vtkPolyData* echoes);

/// Throw avianlidar::MemoryError unless the waveforms of whole beams fit into memory.
void RequireMemoryForWholeBeams(const vtkAvianLidarBeams& beams);

/// Fill in a polyline per recorded stretch of a beam, and add the shapes of the echoes to `echoes`.
/// Takes the waveforms out of the result. @param waveforms empty output
void FillWaveforms(avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams,
  vtkPolyData* echoes, vtkPolyData* waveforms);

/**
 * Fill in a vertex for each beam, in the order of beams: at the strongest return, or else at the
 * display length, m. Point arrays: `beam_id`, `laser_id`, `azimuth` (0.01 deg) and `vertical_angle`
 * (deg), as for echoes; `status` (BeamStatus; the active scalars); `view` (how the direct echo was
 * found); the counts `candidates`, `nodes_visited` and `rays_traced`; `skipped` (SkippedPart) and
 * `skipped_bound` (J).
 *
 * @param result result of a scan, with one report for each beam @param beams beams that were read
 * without an error
 * @param noise noise plan of the scan
 * @param report empty output
 */
void FillReport(const avianlidar::ScanResult& result, const vtkAvianLidarBeams& beams,
  const avianlidar::NoisePlan& noise, vtkPolyData* report);

/**
 * Fill in a vertex for each mover that is present. The vertex is the mover's position at the firing
 * time of the beam that receives most energy from the mover. Arrays: see vtkAvianLidarEchoFilter.
 *
 * @param reports reports of the movers of `setup` from `beams` @param result result of the scan
 * @param report empty output
 */
void FillMovers(const avianlidar::ScanSetup& setup, const avianlidar::ScanBeams& beams,
  const std::vector<avianlidar::MoverReport>& reports, const avianlidar::ScanResult& result,
  vtkPolyData* report);

/// Fill in everything that is needed to repeat the scan, and the bounds of everything that was not
/// modelled. @param sceneChecksum vtkAvianLidarSurfaces::Hash() of the surfaces
void FillFields(const avianlidar::ScanSetup& setup, int preset, vtkFieldData* beamFields,
  const vtkAvianLidarMovers& movers, vtkFieldData* surfaceFields, std::uint64_t sceneChecksum,
  vtkFieldData* fields);
}

#endif
