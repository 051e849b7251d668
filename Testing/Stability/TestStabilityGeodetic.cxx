// SPDX-License-Identifier: BSD-3-Clause
// Frames of the Earth at and beside the poles and the antimeridian, beside the ellipsoid's closed
// form in long double (1e-12 m). CartConvert and cct are compared with in TestGeodeticTransform.py.
#include "GeodeticFrame.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace avianlidar;
using stability::record;
using stability::Worst;

namespace
{
using Point = std::array<double, 3>;

/// Places at the poles and the antimeridian and 1e-13 to 1 degree beside them, with their heights.
std::vector<Point> places()
{
  std::mt19937_64 random(31);
  const auto uniform = [&random]() { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Point> result;
  for (int i = 0; i < 1000; ++i)
  {
    const double beside = i % 10 == 0 ? 0.0 : std::pow(10.0, -13.0 * uniform());
    const double sign = i % 2 ? -1.0 : 1.0;
    const double height = -1e4 + 2e4 * uniform();
    if (i % 4 < 2)
    {
      result.push_back({ 360.0 * uniform() - 180.0, sign * (90.0 - beside), height });
    }
    else
    {
      result.push_back({ sign * (180.0 - beside), 178.0 * uniform() - 89.0, height });
    }
  }
  return result;
}

/// m between a place of ECEF and where the closed form has a geodetic one.
double distanceFromEllipsoid(const Point& geodetic, const Point& ecef)
{
  const long double radian = std::acos(-1.0L) / 180.0L;
  const long double f = 1.0L / 298.257223563L;
  const long double e2 = f * (2.0L - f);
  // From the pole, whose complement is exact: cos and sin of an angle near 90 degrees.
  const long double beside = (90.0L - std::fabs(static_cast<long double>(geodetic[1]))) * radian;
  const long double sine = std::copysign(std::cos(beside), static_cast<long double>(geodetic[1]));
  const long double longitude = geodetic[0] * radian;
  const long double n = 6378137.0L / std::sqrt(1.0L - e2 * sine * sine);
  const long double across = (n + geodetic[2]) * std::sin(beside);
  return static_cast<double>(std::hypot(across * std::cos(longitude) - ecef[0],
    across * std::sin(longitude) - ecef[1], (n * (1.0L - e2) + geodetic[2]) * sine - ecef[2]));
}
}

TEST(StabilityGeodetic, PolesAndAntimeridian)
{
  const GeodeticFrame frame;
  Worst forward;
  Worst back;
  for (const Point& place : places())
  {
    const Point ecef = frame.convert(Frame::Geodetic, Frame::ECEF, place);
    forward.see(distanceFromEllipsoid(place, ecef));
    const Point geodetic = frame.convert(Frame::ECEF, Frame::Geodetic, ecef);
    back.see(distanceFromEllipsoid(geodetic, ecef));
  }
  const std::string range = "0 to 1 deg from the poles and the antimeridian, 1,000 places";
  record({ "Geodetic frames", range, "m, ECEF off the ellipsoid's closed form", 15e-9,
    forward.value() });
  record({ "Geodetic frames", range, "m, likewise of longitude, latitude, height from ECEF", 15e-9,
    back.value() });
}

TEST(StabilityGeodetic, ScenesOnThePolesAndAcrossTheAntimeridian)
{
  Worst off;
  for (const Point& place : places())
  {
    GeodeticFrame frame;
    frame.setOrigin(place[1], place[0], place[2]);
    for (const Point& enu : { Point{ 0.0, 0.0, 0.0 }, Point{ 4e3, -3e3, 200.0 },
           Point{ -5e3, 4e3, -20.0 }, Point{ 1e-3, 1e-3, 0.0 } })
    {
      const Point ecef = frame.convert(Frame::ENU, Frame::ECEF, enu);
      off.see(distanceFromEllipsoid(frame.convert(Frame::ENU, Frame::Geodetic, enu), ecef));
    }
  }
  const std::string range = "a scene of 10 km there";
  record({ "Geodetic frames", range, "m, longitude, latitude, height of a point off its ECEF",
    15e-9, off.value() });
}
