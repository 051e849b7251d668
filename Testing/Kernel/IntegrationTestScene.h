// SPDX-License-Identifier: BSD-3-Clause
// What the tests of integrated beams share.
#ifndef IntegrationTestScene_h
#define IntegrationTestScene_h

#include "EchoTestScene.h"

#include <cmath>
#include <vector>

namespace echotest
{
/// So many rays that any integral takes less time.
constexpr int Very = 10000;

inline EchoSettings integrating(int rays = Very)
{
  EchoSettings settings = directSettings(rays);
  settings.beamSamples = BeamSampleSource::Cells;
  return settings;
}

/// Its one beam, or its first.
inline bool isIntegrated(const ScanResult& result)
{
  return result.reports[0].direct == DirectEcho::Polygons;
}

/// True for each beam that is integrated.
inline std::vector<bool> integratedOf(const ScanResult& result)
{
  std::vector<bool> integrated;
  for (const BeamReport& report : result.reports)
  {
    integrated.push_back(report.direct == DirectEcho::Polygons);
  }
  return integrated;
}

/// Beams all around, in slightly different elevations.
inline ScanBeams ring(int count)
{
  ScanBeams beams;
  for (int i = 0; i < count; ++i)
  {
    const double azimuth = 2.0 * Pi * i / count;
    beams.ids.push_back(i);
    beams.origins.emplace_back(0.0, 0.0, 0.0);
    beams.directions.emplace_back(std::cos(azimuth), std::sin(azimuth), 0.01 * (i % 5));
  }
  return beams;
}
}

#endif
