// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file GeodeticFrame.h
 * @brief Positions on the Earth in four frames, all on the WGS84 ellipsoid; the one place that uses
 * GeographicLib.
 *
 * | frame    | coordinates                                                                   |
 * |----------|-------------------------------------------------------------------------------|
 * | ENU      | east, north, up in metres on the tangent plane at the origin                    |
 * | Geodetic | longitude, latitude in degrees, height above the ellipsoid in metres            |
 * | ECEF     | geocentric x (to 0 N 0 E), y (to 0 N 90 E), z (to the north pole) in metres     |
 * | UTM      | easting, northing of a zone in metres, height above the ellipsoid in metres     |
 *
 * The order is x, y, z as points have it: longitude before latitude, unlike the origin's. Error:
 * GeographicLib's own is 7 nm between geodetic and ECEF within 5000 km of the surface and 5 nm in
 * UTM within 3900 km of the zone's central meridian; on top comes the rounding of the numbers
 * themselves (3 nm for a longitude in degrees, 1 nm for ECEF). Outside of that reach UTM is
 * refused. Poles: any longitude fits latitude +-90 degrees; where a longitude is to be given there,
 * it is 0. Longitudes come out in [-180, 180].
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
  /// With the origin at latitude 0, longitude 0, height 0 and zone 31 north.
  GeodeticFrame();
  ~GeodeticFrame();
  GeodeticFrame(const GeodeticFrame&) = delete;
  GeodeticFrame& operator=(const GeodeticFrame&) = delete;

  /// What is wrong with an origin, or an empty string: latitude in [-90, 90] and longitude in
  /// [-360, 360] degrees, height finite.
  static std::string checkOrigin(double latitude, double longitude, double height);

  /// Put the origin of ENU there (checked by the caller).
  void setOrigin(double latitude, double longitude, double height);

  /// UTM zone of a place, 1 to 60, negative in the south; with the exceptions of Norway and
  /// Svalbard, and by the longitude alone near the poles, where UTM proper ends.
  static int zoneOf(double latitude, double longitude);

  /// Use this zone (1 to 60, negative in the south).
  void setZone(int zone);

  /// What is wrong with a point of a frame, or an empty string: not finite, latitude outside [-90,
  /// 90] degrees, easting or northing outside the reach of UTM.
  static std::string checkPoint(Frame frame, const std::array<double, 3>& point);

  /// The point in another frame; the result of UTM may lie outside its reach, see checkPoint().
  std::array<double, 3> convert(Frame from, Frame to, const std::array<double, 3>& point) const;

private:
  struct Implementation;
  std::unique_ptr<Implementation> Impl;
};
}

#endif
