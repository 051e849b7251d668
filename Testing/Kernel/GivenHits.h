// SPDX-License-Identifier: BSD-3-Clause
// Hits that a test gives instead of drawing and tracing rays.
#ifndef GivenHits_h
#define GivenHits_h

#include "EchoTestScene.h"

#include "SecondaryReflection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace echotest
{
constexpr double Cosine45 = 0.5 * Root2;

/// The rays of a beam along x, from the origin, of which some hit a triangle.
class GivenHits
{
public:
  GivenHits(ScanSetup setup, std::uint32_t rays)
    : Setup(std::move(setup))
  {
    this->Samples.rays = rays;
  }

  /// One after the other, on the side that looks towards the lidar.
  void hit(std::uint32_t ray, std::uint32_t triangle, const Vec3& point, const Vec3& normal)
  {
    const double range = glm::length(point);
    const Vec3 direction = point / range;
    ASSERT_LT(glm::dot(point, normal), 0.0);
    this->Samples.ray.push_back(ray);
    this->Samples.range.push_back(range);
    this->Samples.cosine.push_back(-glm::dot(direction, normal));
    this->Samples.weight.push_back(1.0 / this->Samples.rays);
    this->Samples.surfaces.push_back(
      { triangle, static_cast<std::uint32_t>(this->Samples.size()) });
    this->Samples.nearest = std::min(this->Samples.nearest, range);
    this->Samples.farthest = std::max(this->Samples.farthest, range);
    this->Geometry.dx.push_back(direction.x);
    this->Geometry.dy.push_back(direction.y);
    this->Geometry.dz.push_back(direction.z);
    this->Geometry.nx.push_back(normal.x);
    this->Geometry.ny.push_back(normal.y);
    this->Geometry.nz.push_back(normal.z);
    this->Geometry.surface.push_back(static_cast<std::uint32_t>(this->Geometry.surfaces.size()));
    this->Geometry.surfaces.push_back({ triangle, normal, -glm::dot(normal, point) });
  }

  /// @param lost receives what paths that are left out would return, J @param direct whether the
  /// direct echoes take their share of what the hits can return
  std::vector<SecondaryPath> collect(double* lost = nullptr, bool direct = false) const
  {
    const ScanSetup& setup = this->Setup;
    const BeamFrame frame =
      makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), setup.sensor.halfBeamwidth);
    const SceneTriangles tracerScene(*setup.tree);
    BeamTracer tracer(tracerScene);
    tracer.setBeam(frame);
    const BeamRays none;
    Throughput throughput;
    throughput.measure(setup, this->Samples);
    if (!direct)
    {
      throughput.reflected.assign(this->Samples.size(), 0.0);
    }
    SecondaryTrace trace;
    SecondaryReflection secondary(setup, tracerScene);
    std::vector<SecondaryPath> paths;
    double left = 0.0;
    secondary.collect({ 0, tracerScene, frame, tracer, none, this->Samples, this->Geometry,
                        throughput, nullptr, trace, this->Samples.nearest },
      paths, lost ? *lost : left);
    return paths;
  }

private:
  ScanSetup Setup;
  BeamSamples Samples;
  SampleGeometry Geometry;
};
}

#endif
