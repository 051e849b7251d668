// SPDX-License-Identifier: BSD-3-Clause
// Frames of the Earth: zones, poles, date line. Places as outside programs (CartConvert, cct)
// convert them, round trips, and what is refused are TestGeodeticTransform.py's.
#include "GeodeticFrame.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace avianlidar;

namespace
{
using Point = std::array<double, 3>;

constexpr double A = 6378137.0; // WGS84, m
constexpr double F = 1.0 / 298.257223563;
constexpr double B = A * (1.0 - F);

// Two roundings of an ECEF coordinate (0.9 nm each) and of a longitude in degrees at 180 (3.2 nm),
// with GeographicLib's own 5 to 7 nm: 15 nm.
constexpr double Nano = 15e-9;

void expectPoint(const Point& p, double x, double y, double z, double tolerance = Nano)
{
  EXPECT_NEAR(p[0], x, tolerance);
  EXPECT_NEAR(p[1], y, tolerance);
  EXPECT_NEAR(p[2], z, tolerance);
}
}

TEST(GeodeticFrame, Zones)
{
  EXPECT_EQ(GeodeticFrame::zoneOf(31.2, 121.3), 51);
  EXPECT_EQ(GeodeticFrame::zoneOf(-31.2, 121.3), -51);
  EXPECT_EQ(GeodeticFrame::zoneOf(21.3, -157.9), 4);
  EXPECT_EQ(GeodeticFrame::zoneOf(60.4, 5.3), 32);  // Bergen: the exception of Norway
  EXPECT_EQ(GeodeticFrame::zoneOf(78.2, 15.6), 33); // Longyearbyen: the exception of Svalbard
  EXPECT_EQ(GeodeticFrame::zoneOf(0.0, 180.0), 1);
  EXPECT_EQ(GeodeticFrame::zoneOf(0.0, 179.9), 60);
  EXPECT_EQ(GeodeticFrame::zoneOf(90.0, 0.0), 31);
}

TEST(GeodeticFrame, DateLine)
{
  GeodeticFrame frame;
  frame.setOrigin(-16.5, 179.9999, 0.0); // Taveuni
  const Point east = frame.convert(Frame::ENU, Frame::Geodetic, { 100.0, 0.0, 0.0 });
  EXPECT_LT(east[0], -179.99);
  EXPECT_GE(east[0], -180.0);
  expectPoint(frame.convert(Frame::Geodetic, Frame::ENU, { east[0] + 360.0, east[1], east[2] }),
    100.0, 0.0, 0.0, 2.0 * Nano);
  EXPECT_EQ(frame.convert(Frame::Geodetic, Frame::Geodetic, { 190.0, 5.0, 1.0 })[0], -170.0);
}

TEST(GeodeticFrame, Poles)
{
  GeodeticFrame frame;
  frame.setOrigin(90.0, 0.0, 0.0); // north is where 180 E is
  const Point p = frame.convert(Frame::ENU, Frame::Geodetic, { 0.0, 1000.0, 0.0 });
  EXPECT_NEAR(std::abs(p[0]), 180.0, 1e-12);
  EXPECT_LT(p[1], 90.0);
  const Point pole = frame.convert(Frame::ECEF, Frame::Geodetic, { 0.0, 0.0, B + 2.0 });
  EXPECT_EQ(pole[1], 90.0);
  EXPECT_EQ(pole[0], 0.0);
  EXPECT_NEAR(pole[2], 2.0, Nano);
}
