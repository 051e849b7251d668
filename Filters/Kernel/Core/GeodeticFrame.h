// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file GeodeticFrame.h
 * @brief Positions in four frames on the WGS84 ellipsoid. Only GeodeticFrame uses GeographicLib.
 *
 * | frame    | coordinates                                                                   |
 * |----------|-------------------------------------------------------------------------------|
 * | ENU      | east, north, up in metres on the tangent plane at the origin                  |
 * | Geodetic | longitude, latitude in degrees, height above the ellipsoid in metres          |
 * | ECEF     | geocentric x (to 0 N 0 E), y (to 0 N 90 E), z (to the north pole) in metres   |
 * | UTM      | easting, northing of a zone in metres, height above the ellipsoid in metres   |
 *
 * Coordinates are in the order x, y, z, as in points: longitude precedes latitude, unlike in
 * setOrigin().
 *
 * Source: GeographicLib.
 * Differs: UTM coordinates beyond the reach of GeographicLib are errors.
 * Valid: GeographicLib's own error is 7 nm between geodetic and ECEF within 5000 km of the surface
 * and 5 nm in UTM within 3900 km of the zone's central meridian. The rounding of the numbers adds
 * 3 nm for a longitude in degrees and 1 nm for ECEF. At the poles, where any longitude fits, the
 * longitude returned is 0. Longitudes are returned in [-180, 180].
 * Test: TestGeodeticFrame.cxx.
 */
#ifndef avianlidar_GeodeticFrame_h
#define avianlidar_GeodeticFrame_h

#include <array>
#include <memory>
#include <string>

namespace avianlidar
{
enum class Frame
{
  ENU = 0,
  Geodetic = 1,
  ECEF = 2,
  UTM = 3
};

class GeodeticFrame
{
public:
  /// Frame with the origin at latitude 0, longitude 0, height 0 and with zone 31 north.
  GeodeticFrame();
  ~GeodeticFrame();
  GeodeticFrame(const GeodeticFrame&) = delete;
  GeodeticFrame& operator=(const GeodeticFrame&) = delete;

  /// @return empty for a latitude in [-90, 90] degrees, a longitude in [-360, 360] degrees and a
  /// finite height, else the error in words
  static std::string checkOrigin(double latitude, double longitude, double height);

  /// Set the origin of ENU, degrees and m (checked by the caller).
  void setOrigin(double latitude, double longitude, double height);

  /// UTM zone of a place, 1 to 60, negative in the south, with the exceptions of Norway and
  /// Svalbard. Near the poles, where UTM ends, only the longitude determines the zone.
  static int zoneOf(double latitude, double longitude);

  /// Set the zone of UTM, 1 to 60, negative in the south.
  void setZone(int zone);

  /// @return empty if the point is valid, else the error in words: a coordinate that is not finite,
  /// a latitude outside [-90, 90] degrees, an easting or northing outside the reach of UTM
  static std::string checkPoint(Frame frame, const std::array<double, 3>& point);

  /// Convert a point. The result may lie outside the reach of UTM (checkPoint()).
  std::array<double, 3> convert(Frame from, Frame to, const std::array<double, 3>& point) const;

private:
  struct Implementation;
  std::unique_ptr<Implementation> Impl;
};
}

#endif
