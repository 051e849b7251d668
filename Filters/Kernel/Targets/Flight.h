// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Flight.h
 * @brief Flights of birds: poses over time, from random patterns or from tracks.
 *
 * - Crossings: straight, level flights through a disc. Heading, offset from the centre of the disc,
 *   height and time of passage are uniformly distributed.
 * - Circles: gliding in level, banked circles of radius r with tan(bank) = v^2 / (g r), v the speed
 *   and g gravity, to the left or to the right, with a bank of 20 to 40 degrees. Centres are
 *   uniformly distributed in a disc.
 * - Flock: birds with one velocity on one straight, level crossing (flockPlaces()).
 * - Approach: birds that descend at 3 degrees in straight lines towards the threshold of a runway,
 *   uniformly distributed within 75 m + 0.15 d to either side, with d the distance from the
 *   threshold. This pattern represents birds that come to feed or roost near the runway and meet
 *   arriving aircraft.
 * - Tracks (readFlights()): paths that were measured or computed elsewhere. Attitudes follow from
 *   the paths.
 *
 * Speeds are normally distributed about the species' airspeed with a standard deviation of 10 %,
 * cut at 30 %. Flight is straight between two poses. In a circle, the error of the position is less
 * than 1 cm.
 *
 * Source: flocks of starlings: M. Ballerini et al., "Empirical investigation of starling flocks",
 * Animal Behaviour 76 (2008): flocks are thin and flat, with sides in the ratio 1 : 2.8 : 5.6 for
 * any size, and are denser at the border. No neighbour is nearer than about a wingspan. Distances
 * of nearest neighbours do not depend on the size of the flock.
 * Differs: a flock is a rigid ellipsoid with its short axis upright. The following is assumed: one
 * bird in (4 wingspans)^3 on average, a density at the border of twice the density in the middle,
 * and the speeds, banks and spreads above. There is no wind.
 * Valid: coordinates up to 1e9 m and times up to 1e9 s.
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
  std::string number;      ///< unique number, as text
  std::size_t species = 0; ///< index in a table of species
  bool gliding = false;
  double wingPhase = 0.0; ///< phase at time 0, in wingbeats
  std::vector<Pose> poses;
};

enum class FlightPattern
{
  Crossings = 0,
  Circles = 1,
  Flock = 2,
  Approach = 3
};

/// Settings of random flights.
struct FlightSettings
{
  FlightPattern pattern = FlightPattern::Crossings;
  int numberOfBirds = 10; ///< number of birds, 0 to 100,000
  std::int32_t seed = 0;
  std::array<double, 2> timeRange{ 0.0, 60.0 }; ///< begin and end, s
  Vec3 center{ 0.0 };                           ///< centre of the disc, m
  double radius = 500.0; ///< radius of the disc, or half the length of the approach, m
  std::array<double, 2> heights{ 10.0,
    150.0 };                     ///< heights above the centre, m; unused for approaches
  Vec3 thresholdPosition{ 0.0 }; ///< threshold of the runway, m
  double thresholdHeading = 0.0; ///< heading of landings, degrees clockwise from north
};

/// Returns an empty string, or a sentence that gives the wrong setting, by its name in
/// vtkAvianLidarTracks, and what is expected.
std::string checkFlights(const FlightSettings& settings);

/// Makes flights for the whole time range. Bird k, counted from 1, does not depend on the number of
/// birds, except in a flock. Throws MemoryError if there is not enough memory.
/// @param index index of the species, copied into the flights
std::vector<Flight> makeFlights(
  const FlightSettings& settings, const BirdSpecies& species, std::size_t index);

/// Positions of birds in a flock relative to its middle, m: x along its longest axis, z upright
/// along its shortest axis. No two birds are nearer to each other than the span.
/// @param span wingspan, m
std::vector<Vec3> flockPlaces(std::int32_t seed, std::size_t birds, double span);

/// Sets orientations from the path: forward along the velocity, with the bank atan(v w / g) of a
/// turn of w rad/s, at most 60 degrees. Where the path does not move horizontally, the bird is
/// level and keeps its heading. Requires at least two poses and increasing times.
void orientAlongPath(Flight& flight);

/// Phase of the wingbeat of a track at time 0. @param track index of the track
double trackWingPhase(std::int32_t seed, std::size_t track);
}

#endif
