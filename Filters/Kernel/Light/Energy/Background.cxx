// SPDX-License-Identifier: BSD-3-Clause
#include "Background.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
double radianceSeen(const ScanSetup& setup, const SceneTriangles& scene, const BeamSamples& samples,
  const Vec3& origin)
{
  const Sensor& sensor = setup.sensor;
  const double azimuth = RadiansPerDegree * sensor.sunAzimuth;
  const double elevation = RadiansPerDegree * sensor.sunElevation;
  const double sunlight = sensor.sunElevation < 0.0 ? 0.0 : sensor.sunlight;
  const Vec3 sun(std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
    std::sin(elevation));
  double filled = 0.0;
  double ofSurfaces = 0.0;
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      double share = 0.0;
      for (std::uint32_t i = begin; i < end; ++i)
      {
        share += samples.weight[i];
      }
      const Vec3 corner = scene.corner(triangle, 0);
      const Vec3 normal =
        glm::cross(scene.corner(triangle, 1) - corner, scene.corner(triangle, 2) - corner);
      const double length = glm::length(normal);
      const double side = glm::dot(normal, origin - corner) < 0.0 ? -1.0 : 1.0;
      const double cosine = length > 0.0 ? side * glm::dot(normal, sun) / length : 0.0;
      filled += share;
      ofSurfaces += share * setup.material(triangle).albedo() *
        (sensor.backgroundRadiance + sunlight * std::max(0.0, cosine) / Pi);
    });
  return ofSurfaces + std::max(0.0, 1.0 - filled) * sensor.backgroundRadiance;
}
}
