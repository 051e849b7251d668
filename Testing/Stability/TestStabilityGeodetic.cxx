// SPDX-License-Identifier: BSD-3-Clause
// Frames of the Earth at and beside the poles and the antimeridian, beside the ellipsoid's closed
// form in 50 digits. CartConvert and cct are compared with in TestGeodeticTransform.py.
#include "GeodeticFrame.h"
#include "StabilityTable.h"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace avianlidar;
using stability::record;
using stability::Worst;

namespace
{
using Point = std::array<double, 3>;
using Digits50 = boost::multiprecision::cpp_bin_float_50;

/// Places at the poles and the antimeridian and 1e-13 to 1 degree beside them, with their heights.
std::vector<Point> places()
{
  std::mt19937_64 random(31);
  const auto uniform = [&random]() { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Point> result;
  for (int i = 0; i < 4000; ++i)
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

double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// m between a place of ECEF and where the closed form has a geodetic one.
double distanceFromEllipsoid(const Point& geodetic, const Point& ecef)
{
  const Digits50 radian = boost::math::constants::pi<Digits50>() / 180;
  const Digits50 a = 6378137;
  const Digits50 f = 1 / Digits50("298.257223563");
  const Digits50 e2 = f * (2 - f);
  const Digits50 latitude = geodetic[1] * radian;
  const Digits50 longitude = geodetic[0] * radian;
  const Digits50 n = a / sqrt(1 - e2 * sin(latitude) * sin(latitude));
  const Digits50 x = (n + geodetic[2]) * cos(latitude) * cos(longitude) - ecef[0];
  const Digits50 y = (n + geodetic[2]) * cos(latitude) * sin(longitude) - ecef[1];
  const Digits50 z = (n * (1 - e2) + geodetic[2]) * sin(latitude) - ecef[2];
  return static_cast<double>(sqrt(x * x + y * y + z * z));
}
}

TEST(StabilityGeodetic, PolesAndAntimeridian)
{
  const GeodeticFrame frame;
  Worst forward;
  Worst back;
  Worst around;
  Worst outside;
  for (const Point& place : places())
  {
    const Point ecef = frame.convert(Frame::Geodetic, Frame::ECEF, place);
    forward.see(distanceFromEllipsoid(place, ecef));
    const Point geodetic = frame.convert(Frame::ECEF, Frame::Geodetic, ecef);
    back.see(distanceFromEllipsoid(geodetic, ecef));
    outside.see(std::fabs(geodetic[0]) <= 180.0 && std::fabs(geodetic[1]) <= 90.0 &&
          GeodeticFrame::checkPoint(Frame::Geodetic, geodetic).empty()
        ? 0.0
        : 1.0);
    // The same meridian by another name. Beyond 180 degrees the longitude itself is rounded, so
    // whole degrees.
    const Point whole{ std::round(place[0]), place[1], place[2] };
    around.see(distance(frame.convert(Frame::Geodetic, Frame::ECEF, whole),
      frame.convert(Frame::Geodetic, Frame::ECEF,
        { whole[0] + (whole[0] > 0.0 ? -360.0 : 360.0), whole[1], whole[2] })));
  }
  const std::string range = "0 to 1 deg from the poles and the antimeridian, 4,000 places";
  record({ "Geodetic frames", range, "m, ECEF off the ellipsoid's closed form in 50 digits", 15e-9,
    forward.value() });
  record({ "Geodetic frames", range, "m, likewise of longitude, latitude, height from ECEF", 15e-9,
    back.value() });
  record({ "Geodetic frames", range, "m between a meridian and the same 360 deg on", 0.0,
    around.value() });
  record({ "Geodetic frames", range,
    "1 if a longitude is beyond 180 or a latitude beyond 90 deg, else 0", 0.0, outside.value() });
}

TEST(StabilityGeodetic, ScenesOnThePolesAndAcrossTheAntimeridian)
{
  Worst off;
  Worst utm;
  for (const Point& place : places())
  {
    GeodeticFrame frame;
    frame.setOrigin(place[1], place[0], place[2]);
    frame.setZone(GeodeticFrame::zoneOf(place[1], place[0]));
    for (const Point& enu : { Point{ 0.0, 0.0, 0.0 }, Point{ 4e3, -3e3, 200.0 },
           Point{ -5e3, 4e3, -20.0 }, Point{ 1e-3, 1e-3, 0.0 } })
    {
      const Point ecef = frame.convert(Frame::ENU, Frame::ECEF, enu);
      off.see(distanceFromEllipsoid(frame.convert(Frame::ENU, Frame::Geodetic, enu), ecef));
      utm.see(distance(
        enu, frame.convert(Frame::UTM, Frame::ENU, frame.convert(Frame::ENU, Frame::UTM, enu))));
    }
  }
  const std::string range = "a scene of 10 km there";
  record({ "Geodetic frames", range, "m, longitude, latitude, height of a point off its ECEF",
    15e-9, off.value() });
  record(
    { "Geodetic frames", range, "m, a point after the way to UTM and back", 30e-9, utm.value() });
}
