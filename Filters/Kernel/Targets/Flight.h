// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Flight.h
 * @brief Flights of birds: poses over time, by patterns with random numbers, or from tracks.
 *
 * - Crossings: straight, level flights at random headings through a disc. The bird passes a random
 *   line through it, evenly spread across, at a time evenly spread over the time range.
 * - Circles: gliding in level, banked circles of radius r with tan(bank) = v^2 / (g r), to the left
 *   or to the right, with a bank of 20 to 40 degrees. Their centres are evenly spread in a disc.
 * - Flock: a body of birds with one velocity, on one straight, level crossing (flockPlaces()).
 * - Approach: birds that descend at 3 degrees along the approach of a runway, in straight lines
 *   towards its threshold, evenly spread within 75 m + 0.15 d to either side, d the distance. It
 *   stands for birds that come in to feed or roost there and meet arriving aircraft.
 * - Tracks (readFlights()): measured or made elsewhere; heading, pitch and bank follow from the
 *   path.
 *
 * Speeds are normally distributed about the species' airspeed with 10 %, cut at 30 %. Between two
 * poses flight is straight; those of a circle are so close that this errs by less than 1 cm.
 *
 * Source: flocks of starlings: M. Ballerini et al., "Empirical investigation of starling flocks",
 * Animal Behaviour 76 (2008): thin, lying flat, sides as 1 : 2.8 : 5.6 whatever the size; no
 * neighbour nearer than about a wingspan; denser at the border; nearest neighbours' distances do
 * not depend on the size.
 * Differs: a flock is rigid, an ellipsoid with its short axis upright. Assumed: a bird in (4
 * wingspans)^3 on average, twice as dense at the border as in the middle; speeds, banks and
 * scatters above. No wind.
 * Valid: coordinates and times up to 1e9 m and s.
 * Test: TestFlight.cxx.
 */
#ifndef avianlidar_Flight_h
#define avianlidar_Flight_h

#include "Bird.h"
#include "Mover.h"
#include "Vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Largest coordinate (m) and time (s) of a flight.
constexpr double LargestOfFlight = 1e9;

struct Flight
{
  std::string number;      ///< unique
  std::size_t species = 0; ///< in a table of species
  bool gliding = false;
  double wingPhase = 0.0; ///< of the wingbeat at time 0, 1 is a whole one
  std::vector<Pose> poses;
};

enum class FlightPattern
{
  Crossings = 0,
  Circles = 1,
  Flock = 2,
  Approach = 3
};

/// Flights that are made of random numbers.
struct FlightSettings
{
  FlightPattern pattern = FlightPattern::Crossings;
  int numberOfBirds = 10; ///< 0 to 100,000
  std::int32_t seed = 0;
  std::array<double, 2> timeRange{ 0.0, 60.0 }; ///< s
  Vec3 center{ 0.0 };                           ///< m
  double radius = 500.0;                        ///< of the disc, m; half the approach's length
  std::array<double, 2> heights{ 10.0, 150.0 }; ///< above the center, m; not of approaches
  Vec3 thresholdPosition{ 0.0 };                ///< of approaches, m
  double thresholdHeading = 0.0;                ///< in which arrivals land, degrees from north
};

/// Empty, or which of the settings is wrong and what was expected, by the names of
/// vtkAvianLidarTracks.
std::string checkFlights(const FlightSettings& settings);

/// Flights for the whole time range. Bird k, counted from 1, depends on how many follow it in a
/// flock only. Throws MemoryError if there is not enough memory.
/// @param index of the species, which is handed on
std::vector<Flight> makeFlights(
  const FlightSettings& settings, const BirdSpecies& species, std::size_t index);

/// Places of birds in a flock about its middle, m: x along its longest axis, z along its shortest
/// one, upright. None is nearer to another than the span.
/// @param span m
std::vector<Vec3> flockPlaces(std::int32_t seed, std::size_t birds, double span);

/// Orientations from the path: forward along the velocity, banked by atan(v w / g) for a turn of w
/// rad/s, at most 60 degrees. Where a path does not move forward, the bird is level and keeps its
/// heading. At least two poses, times rise.
void orientAlongPath(Flight& flight);

/// The part of the wingbeat with which a track begins at time 0, by its place among the tracks.
double trackWingPhase(std::int32_t seed, std::size_t track);

/// A table of tracks: a header "id,species,time,x,y,z" or
/// "id,species,time,longitude,latitude,height", lines that begin with # are comments. Rows of
/// several tracks may alternate. Throws std::runtime_error naming file, line and column.
/// @param file for messages @param known all species
/// @param origin of the scene: latitude, longitude in degrees, height above the ellipsoid, m
/// (checked by the caller, GeodeticFrame::checkOrigin())
std::vector<Flight> readFlights(const std::string& text, const std::string& file,
  const std::vector<BirdSpecies>& known, const std::array<double, 3>& origin, std::int32_t seed);
}

#endif
