// SPDX-License-Identifier: BSD-3-Clause
// Walls and corners of the tests of extremes, and their energies in closed form.
#ifndef StabilityScenes_h
#define StabilityScenes_h

#include "EchoTestScene.h"

namespace stability
{
constexpr double Qs = 3.6e-4; ///< energy of the default pulse, J
const avianlidar::Material Diffuse{ 0.146, 0.0, 0.0 };

/// A wall across the axis x that every beam of less than a radian lies on.
inline echotest::Scene wall(double distance, const avianlidar::Material& material = Diffuse)
{
  return echotest::squareAt(distance, 1e3 * distance, material);
}

/// Energy that a uniform beam of half-beamwidth t receives of a diffuse wall. @param mean mean of
/// (1 - cos theta)/(1 - cos t) over the energy of the beam
inline double energyOfWall(double t, double mean = 0.5)
{
  const double half = std::sin(0.5 * t);
  return Qs * Diffuse.kd * (1.0 - 2.0 * half * half * mean);
}

/// A corner of a metal and a matt wall, 100 m away: mirror paths, connections, and several units.
inline echotest::Scene corner()
{
  using avianlidar::Vec3;
  echotest::Scene scene;
  for (const int side : { -1, 1 })
  {
    const Vec3 along = 10.0 * Vec3(-1.0, side, 0.0);
    scene.plate(Vec3(100.0, 0.0, 0.0) + along, along, Vec3(0.0, 0.0, 20.0),
      side > 0 ? echotest::Metal : echotest::Wood, side);
  }
  return scene;
}

inline avianlidar::Sensor intoTheCorner()
{
  avianlidar::Sensor sensor;
  sensor.halfBeamwidth = 0.05;
  sensor.lowerEnergyLimit = 1e-8;
  return sensor;
}

/// Settings of the preset Paper: independent rays, one descent per beam, both constraints, a point
/// for each range unit.
inline avianlidar::EchoSettings paper(avianlidar::LightEnergyThreshold threshold)
{
  avianlidar::EchoSettings settings;
  settings.beamSamples = avianlidar::BeamSampleSource::Rays;
  settings.sampling = avianlidar::Sampling::MonteCarlo;
  settings.returnMode = avianlidar::ReturnMode::RangeUnits;
  settings.traceMode = avianlidar::TraceMode::Beams;
  settings.lightEnergyThreshold = threshold;
  settings.noise = false;
  return settings;
}

/// Its tree: two boxes a node.
constexpr avianlidar::TreeOptions PaperTree{ avianlidar::SplitRule::Median,
  avianlidar::BoundingVolumeType::BinaryAABB, 1 };
constexpr avianlidar::LightEnergyThreshold Readings[] = { avianlidar::LightEnergyThreshold::Limit,
  avianlidar::LightEnergyThreshold::LimitPerRay };
}

#endif
