// SPDX-License-Identifier: BSD-3-Clause
// Beams that are not round: rays, frames, energies. Oracles: closed forms, integrals by midpoints,
// rays that are drawn and tested without the kernel.
#include "BeamSampler.h"
#include "CellTestScene.h"
#include "Sanitized.h"
#include "Statistics.h"

#include <algorithm>
#include <cmath>
#include <random>

using namespace celltest;

namespace
{
struct Shape
{
  BeamOutline outline;
  double along, across; ///< rad
  double rotation;      ///< deg
  BeamProfile profile;
  double truncation;
};

const Shape Shapes[] = {
  { BeamOutline::Ellipse, 5e-3, 1e-3, 0.0, BeamProfile::Uniform, 1.0 },
  { BeamOutline::Ellipse, 1e-3, 4e-3, 30.0, BeamProfile::Uniform, 1.0 },
  { BeamOutline::Ellipse, 5e-3, 1e-3, -70.0, BeamProfile::Gaussian, 1.0 },
  { BeamOutline::Ellipse, 5e-3, 2e-3, 15.0, BeamProfile::Gaussian, 2.5 },
  { BeamOutline::Ellipse, 5e-3, 0.0, 0.0, BeamProfile::Gaussian, 0.5 },
  { BeamOutline::Rectangle, 5e-3, 1e-3, 0.0, BeamProfile::Uniform, 1.0 },
  { BeamOutline::Rectangle, 1e-3, 3e-3, 40.0, BeamProfile::Uniform, 1.0 },
  { BeamOutline::Rectangle, 4e-3, 0.0, 10.0, BeamProfile::Uniform, 1.0 },
  { BeamOutline::Rectangle, 5e-3, 1e-3, -20.0, BeamProfile::Gaussian, 1.0 },
  { BeamOutline::Rectangle, 5e-3, 2e-3, 90.0, BeamProfile::Gaussian, 3.0 },
};

Sensor sensorOf(const Shape& s)
{
  Sensor sensor = openSensor(s.along);
  sensor.beamOutline = s.outline;
  sensor.halfBeamwidthAcross = s.across;
  sensor.beamRotation = s.rotation;
  sensor.beamProfile = s.profile;
  sensor.gaussianTruncation = s.truncation;
  return sensor;
}

double acrossOf(const Shape& s)
{
  return s.across > 0.0 ? s.across : s.along;
}

/// Whether the outline holds a place, in half-widths.
bool isInside(const Shape& s, double u, double v)
{
  return s.outline == BeamOutline::Rectangle ? std::max(std::fabs(u), std::fabs(v)) <= 1.0
                                             : u * u + v * v <= 1.0;
}

/// Share of the energy where a function of the place is true.
template <class F>
double shareWhere(const Shape& s, F isCounted)
{
  constexpr int steps = 1500;
  double all = 0.0;
  double counted = 0.0;
  for (int i = 0; i < steps; ++i)
  {
    for (int k = 0; k < steps; ++k)
    {
      const double u = (2.0 * i + 1.0) / steps - 1.0;
      const double v = (2.0 * k + 1.0) / steps - 1.0;
      const double fall =
        s.profile == BeamProfile::Gaussian ? 2.0 * s.truncation * s.truncation : 0.0;
      const double light = isInside(s, u, v) ? std::exp(-fall * (u * u + v * v)) : 0.0;
      all += light;
      counted += isCounted(u, v) ? light : 0.0;
    }
  }
  return counted / all;
}

/// Right and up in the half-widths of a beam along x, with the horizontal right at -y.
struct Place
{
  double u, v;
};

Place placeOf(const Shape& s, const Vec3& direction)
{
  const double right = -direction.y / direction.x;
  const double up = direction.z / direction.x;
  const double turn = s.rotation * Degree;
  return { (std::cos(turn) * right + std::sin(turn) * up) / std::tan(s.along),
    (std::cos(turn) * up - std::sin(turn) * right) / std::tan(acrossOf(s)) };
}

BeamFrame frameOf(const Shape& s, const Vec3& direction = { 1.0, 0.0, 0.0 })
{
  return makeBeamFrame(Vec3(0.0), direction, BeamShape(sensorOf(s)).width());
}

/// The rays of many beams.
std::vector<Place> draw(const Shape& s, Sampling sampling, std::uint32_t count)
{
  BeamSampler sampler(sensorOf(s), sampling, count);
  const BeamFrame frame = frameOf(s);
  std::vector<Place> all;
  BeamRays rays;
  for (std::uint64_t beam = 0; beam < 40000 / count; ++beam)
  {
    sampler.draw(5, beam, rays);
    for (std::size_t n = 0; n < count; ++n)
    {
      all.push_back(placeOf(s, frame.direction(rays.x[n], rays.y[n])));
    }
  }
  return all;
}
}

TEST(BeamShape, RaysFollowOutlineAndProfile)
{
  for (const Shape& s : Shapes)
  {
    for (const auto& [sampling, count] : { std::pair{ Sampling::MonteCarlo, 100u },
           { Sampling::Stratified, 100u }, { Sampling::Stratified, 1000u } })
    {
      const std::vector<Place> rays = draw(s, sampling, count);
      for (const double limit : { -0.6, -0.2, 0.1, 0.5 })
      {
        double byU = 0.0, byV = 0.0, byBoth = 0.0;
        for (const Place& p : rays)
        {
          ASSERT_TRUE(isInside(s, (1.0 - 1e-12) * p.u, (1.0 - 1e-12) * p.v));
          byU += p.u < limit;
          byV += p.v < limit;
          byBoth += p.u + p.v < limit;
        }
        const auto all = static_cast<double>(rays.size());
        EXPECT_NEAR(byU / all, shareWhere(s, [=](double u, double) { return u < limit; }), 8e-3);
        EXPECT_NEAR(byV / all, shareWhere(s, [=](double, double v) { return v < limit; }), 8e-3);
        EXPECT_NEAR(
          byBoth / all, shareWhere(s, [=](double u, double v) { return u + v < limit; }), 8e-3);
      }
    }
  }
}

TEST(BeamShape, SolidAngleIsThatOfTheOutline)
{
  for (Shape s : Shapes)
  {
    for (const double wider : { 1.0, 20.0 })
    {
      s.along *= wider;
      s.across *= wider;
      if (s.outline == BeamOutline::Ellipse && s.across == 0.0)
      {
        continue;
      }
      const double a = std::tan(s.along);
      const double b = std::tan(acrossOf(s));
      constexpr int steps = 2000;
      double sum = 0.0;
      for (int i = 0; i < steps * steps; ++i)
      {
        const double u = (2.0 * (i % steps) + 1.0) / steps - 1.0;
        const double v = (2.0 * (i / steps) + 1.0) / steps - 1.0;
        sum += isInside(s, u, v)
          ? 4.0 * a * b / steps / steps * std::pow(1.0 + a * a * u * u + b * b * v * v, -1.5)
          : 0.0;
      }
      EXPECT_NEAR(sensorOf(s).solidAngle() / sum, 1.0, 3e-4) << wider;
    }
  }
}

TEST(BeamShape, AxesAreTurnedFromTheHorizontal)
{
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const Shape& s : Shapes)
  {
    const BeamShape shape(sensorOf(s));
    for (int k = 0; k < 20 && !shape.isRound(); ++k)
    {
      const Vec3 direction(normal(random), normal(random), normal(random));
      const BeamFrame frame = frameOf(s, direction);
      const Vec3 axis = unitVector(direction);
      const Vec3 right = unitVector(glm::cross(axis, Vec3(0.0, 0.0, 1.0)));
      const Vec3 up = glm::cross(right, axis);
      const double turn = s.rotation * Degree;
      const Vec3 along = std::cos(turn) * right + std::sin(turn) * up;
      const Vec3 across = std::cos(turn) * up - std::sin(turn) * right;
      for (const double u : { -1.3, -0.999, 0.2, 0.9 })
      {
        for (const double v : { -0.3, 0.45, 1.001 })
        {
          const Vec3 ray =
            7.0 * (axis + u * std::tan(s.along) * along + v * std::tan(acrossOf(s)) * across);
          EXPECT_EQ(frame.contains(ray), isInside(s, u, v)) << u << " " << v;
          const Vec3 p = frame.toPlane(ray);
          EXPECT_LT(safeLength(7.0 * frame.direction(p.x / p.z, p.y / p.z) - ray), 1e-14 * 7.0);
          EXPECT_EQ(shape.holds(p.x / p.z, p.y / p.z), isInside(s, u, v));
          const double tangent = safeLength(glm::cross(axis, ray)) / glm::dot(axis, ray);
          EXPECT_NEAR(frame.tanHalf * frame.tanHalf * frame.radius2(p.x / p.z, p.y / p.z),
            tangent * tangent, 1e-12 * tangent * tangent);
        }
      }
    }
  }
}

TEST(BeamShape, AxesFollowTheSensor)
{
  // A sensor that lies on its side: what was horizontal stands upright.
  Sensor sensor = sensorOf(Shapes[0]);
  sensor.up = { 0.0, 1.0, 0.0 };
  sensor.beamRotation = 30.0;
  const BeamFrame lying = makeBeamFrame(Vec3(0.0), { 1.0, 0.0, 0.0 }, BeamShape(sensor).width());
  // To its right is z.
  EXPECT_LT(safeLength(lying.e1 - Vec3(0.0, 0.5, std::sqrt(0.75))), 1e-15);
  // Straight up there is no horizontal: a frame all the same.
  sensor.up = { 0.0, 0.0, 1.0 };
  const BeamFrame above = makeBeamFrame(Vec3(0.0), { 0.0, 0.0, 1.0 }, BeamShape(sensor).width());
  EXPECT_NEAR(glm::dot(above.e1, above.e1), 1.0, 1e-15);
  EXPECT_NEAR(glm::dot(above.e1, above.e2), 0.0, 1e-15);
  EXPECT_NEAR(glm::dot(above.e2, above.e2), above.flatness2, 1e-15);
}

TEST(BeamShape, AnEdgeCutsAShare)
{
  // A plate that ends along a line, in any direction, at some distance from the axis.
  for (const Shape& s : Shapes)
  {
    const Sensor sensor = sensorOf(s);
    const double a = std::tan(s.along);
    const double b = std::tan(acrossOf(s));
    const double turn = s.rotation * Degree;
    for (const double angle : { 0.0, 50.0, 90.0, 200.0 })
    {
      if (IsSanitized && angle != 50.0)
      {
        continue;
      }
      for (const double at : { -0.4, 0.1, 0.7 })
      {
        // In half-widths the edge is cos u + sin v = at; the plate lies beyond.
        const double nu = std::cos(angle * Degree) / a;
        const double nv = std::sin(angle * Degree) / b;
        const double n = std::hypot(nu, nv);
        const Vec3 along(0.0, -std::cos(turn), std::sin(turn));
        const Vec3 across(0.0, std::sin(turn), std::cos(turn));
        const Vec3 out = (nu * along + nv * across) / n;
        const Vec3 side = (nu * across - nv * along) / n;
        Scene scene;
        fine(scene, Vec3(100.0, 0.0, 0.0) + (100.0 * at / n + 3.0) * out, 3.0 * out, 3.0 * side, 12,
          Matt, 1);
        const double truth = sensor.pulseEnergy * Matt.kd *
          shareWhere(s,
            [=](double u, double v)
            { return std::cos(angle * Degree) * u + std::sin(angle * Degree) * v > at; });
        const ScanResult cells = runScan(makeSetup(scene, sensor, inCells(400)), alike(40));
        statistics::Moments errors;
        for (const Echo& echo : cells.echoes)
        {
          errors.add(echo.energyStdError);
        }
        const double one = sensor.pulseEnergy * Matt.kd;
        EXPECT_NEAR(
          receivedFrom(cells) / 40.0, truth, 1.5e-3 * one + 4.0 * errors.rms() / std::sqrt(40.0))
          << s.rotation << " " << angle << " " << at;
        EXPECT_LT(errors.rms(), 0.03 * one);
        EXPECT_NEAR(received(scene, sensor, directSettings(20000)), truth, 6e-3 * one);
      }
    }
  }
}

TEST(BeamShape, PathsOverTwoReflectionsAreTheSameByCellsAndRays)
{
  // Two mirrors at right angles send light back; two matt walls some of it.
  for (const Material& material : { Metal, Matt })
  {
    for (const Shape& s : { Shapes[1], Shapes[3], Shapes[6], Shapes[8] })
    {
      Scene scene;
      const double half = std::sqrt(0.5);
      fine(scene, Vec3(50.0 - half, half, 0.0), Vec3(half, -half, 0.0), Vec3(0.0, 0.0, 1.0), 8,
        material, 1);
      fine(scene, Vec3(50.0 - half, -half, 0.0), Vec3(half, half, 0.0), Vec3(0.0, 0.0, 1.0), 8,
        material, 2);
      EchoSettings cells = inCells(400);
      EchoSettings rays = directSettings(4000);
      cells.numberOfReflections = rays.numberOfReflections = 2;
      const auto mean = [&](const EchoSettings& settings)
      { return receivedFrom(runScan(makeSetup(scene, sensorOf(s), settings), alike(30))) / 30.0; };
      const double byCells = mean(cells);
      EXPECT_NEAR(byCells / mean(rays), 1.0, 0.03);
      cells.numberOfReflections = 1;
      EXPECT_GT(byCells, 1.02 * mean(cells)); // they are there
    }
  }
}

TEST(BeamShape, TwoEqualHalfBeamwidthsAreARoundBeam)
{
  const Scene scene = clutter(3);
  Sensor sensor = openSensor();
  for (const BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
  {
    sensor.beamProfile = profile;
    sensor.halfBeamwidthAcross = 0.0;
    const double round = received(scene, sensor, inCells());
    sensor.halfBeamwidthAcross = sensor.halfBeamwidth;
    EXPECT_EQ(received(scene, sensor, inCells()), round);
    // Nearly the same beam by the other way.
    sensor.halfBeamwidthAcross = 0.9999 * sensor.halfBeamwidth;
    EXPECT_NEAR(received(scene, sensor, inCells(400)) / round, 1.0, 0.02);
  }
}
