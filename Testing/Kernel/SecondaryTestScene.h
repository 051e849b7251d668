// SPDX-License-Identifier: BSD-3-Clause
// Grooves, and scans of them after two reflections.
#ifndef SecondaryTestScene_h
#define SecondaryTestScene_h

#include "EchoTestScene.h"

#include <cmath>
#include <map>
#include <utility>

namespace echotest
{
/// Two reflections, without anything else.
inline EchoSettings secondarySettings(
  int rays, int connections = 8, BeamSampleSource source = BeamSampleSource::Rays)
{
  EchoSettings settings = directSettings(rays);
  settings.beamSamples = source;
  settings.numberOfReflections = 2;
  settings.numberOfConnections = connections;
  return settings;
}

/// Two plates that meet in the edge x = 100, y = 0 and open towards the lidar, each `half` from the
/// plane y = 0.
inline Scene groove(double half, const Material& m, double gap = 0.0, double length = 30.0)
{
  Scene scene;
  for (int side : { -1, 1 })
  {
    const Vec3 along(-std::cos(half), side * std::sin(half), 0.0);
    const double start = gap / std::sin(half);
    const Vec3 center = Vec3(100.0, 0.0, 0.0) + (start + 0.5 * length) * along;
    scene.plate(center, 0.5 * length * along, Vec3(0.0, 0.0, length), m, side > 0);
  }
  return scene;
}

/// Energies of perceived range units, J, by beam and range.
inline std::map<std::pair<std::size_t, double>, double> unitsOf(const ScanResult& result)
{
  std::map<std::pair<std::size_t, double>, double> units;
  for (std::size_t e = 0; e < result.echoes.size(); ++e)
  {
    units[{ result.beamOfEcho[e], result.echoes[e].range }] = result.echoes[e].energyReceived;
  }
  return units;
}

/// J that came after two reflections, of all echoes.
inline double secondaryOf(const ScanResult& result)
{
  double sum = 0.0;
  for (const Echo& echo : result.echoes)
  {
    sum += echo.returnEnergy * echo.secondaryShare;
  }
  return sum;
}
}

#endif
