// SPDX-License-Identifier: BSD-3-Clause
#include "Flight.h"

#include "AvailableMemory.h"
#include "Random.h"
#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr double Gravity = 9.81;
constexpr double Degree = Pi / 180.0;
constexpr double Largest = LargestOfFlight;
constexpr int MostBirds = 100000;

// The values in this block are assumed.
constexpr double SpeedSpread = 0.1;
constexpr double MostSpread = 0.3;
constexpr double LeastCircleBank = 20.0 * Degree;
constexpr double MostCircleBank = 40.0 * Degree;
constexpr double MostTrackBank = 60.0 * Degree;
constexpr double GlideAngle = 3.0 * Degree;
constexpr double ApproachHalfWidth = 75.0; // half width at the threshold, m
constexpr double ApproachSplay = 0.15;
constexpr double SpansPerBird = 4.0;
constexpr double BorderExcess = 1.0; // density at the border over density in the middle, less 1

// Ballerini et al. 2008.
constexpr double FlockWidth = 2.8; // width of a flock, in thicknesses
constexpr double FlockLength = 5.6;

constexpr double PathError = 0.01; // largest error of a path by straight pieces, m

/// Purposes of a bird's random numbers.
enum Draw : std::uint64_t
{
  DrawSpeed = 0,
  DrawCourse = 1,  ///< heading and offset
  DrawPassage = 2, ///< time and height
  DrawWings = 3,   ///< phase of the wings
  DrawCircle = 4   ///< bank and sense of rotation
};

class BirdNumbers
{
public:
  BirdNumbers(std::int32_t seed, std::uint64_t bird)
    : Seed(seed)
    , Bird(bird)
  {
  }
  std::array<double, 2> operator()(Draw draw) const
  {
    return uniformPair(this->Seed, this->Bird, draw, RandomPurpose::Flights);
  }

private:
  std::int32_t Seed;
  std::uint64_t Bird;
};

double between(double low, double high, double share)
{
  return low + (high - low) * share;
}

double speedOf(const BirdNumbers& numbers, const BirdSpecies& species)
{
  const auto [first, second] = numbers(DrawSpeed);
  const double normal = std::sqrt(-2.0 * std::log(first)) * std::cos(2.0 * Pi * second);
  return species.airspeed * (1.0 + std::clamp(SpeedSpread * normal, -MostSpread, MostSpread));
}

Vec3 forward(double heading)
{
  return { std::sin(heading), std::cos(heading), 0.0 };
}

Vec3 right(double heading)
{
  return { std::cos(heading), -std::sin(heading), 0.0 };
}

/// @param heading heading clockwise from north, rad @param pitch pitch up, rad @param bank bank to
/// the right, rad
glm::dquat orientationOf(double heading, double pitch, double bank)
{
  return glm::angleAxis(-heading, Vec3(0.0, 0.0, 1.0)) *
    glm::angleAxis(pitch, Vec3(1.0, 0.0, 0.0)) * glm::angleAxis(bank, Vec3(0.0, 1.0, 0.0));
}

double horizontal(const Vec3& v)
{
  return std::hypot(v.x, v.y);
}

double headingOf(const Vec3& v)
{
  return std::atan2(v.x, v.y);
}

double pitchOf(const Vec3& v)
{
  return std::atan2(v.z, horizontal(v));
}

Flight flightOf(const BirdNumbers& numbers, int bird, std::size_t species)
{
  Flight flight;
  flight.number = std::to_string(bird);
  flight.species = species;
  flight.wingPhase = numbers(DrawWings)[0];
  return flight;
}

/// A straight course: position at a time, and velocity.
struct Course
{
  double time;
  Vec3 position;
  Vec3 velocity;
};

/// A level course past the centre. @param room room kept free below and above, m
Course crossing(
  const FlightSettings& settings, const BirdSpecies& species, std::uint64_t bird, double room)
{
  const BirdNumbers numbers(settings.seed, bird);
  const double heading = 2.0 * Pi * numbers(DrawCourse)[0];
  const double offset = between(-settings.radius, settings.radius, numbers(DrawCourse)[1]);
  const auto [low, high] = settings.heights;
  const double margin = std::min(room, 0.5 * (high - low));
  const double height = between(low + margin, high - margin, numbers(DrawPassage)[1]);
  return { between(settings.timeRange[0], settings.timeRange[1], numbers(DrawPassage)[0]),
    settings.center + offset * right(heading) + Vec3(0.0, 0.0, height),
    speedOf(numbers, species) * forward(heading) };
}

Course approach(const FlightSettings& settings, const BirdSpecies& species, std::uint64_t bird)
{
  const BirdNumbers numbers(settings.seed, bird);
  const double heading = settings.thresholdHeading * Degree;
  const double distance = 2.0 * settings.radius * numbers(DrawPassage)[0];
  const double side = between(-1.0, 1.0, numbers(DrawCourse)[1]);
  const double slope = std::tan(GlideAngle);
  const Vec3 along = forward(heading) - side * ApproachSplay * right(heading) - Vec3(0, 0, slope);
  return { settings.timeRange[1],
    settings.thresholdPosition + side * ApproachHalfWidth * right(heading) - distance * along,
    speedOf(numbers, species) * unitVector(along) };
}

void fly(Flight& flight, const Course& course, const std::array<double, 2>& timeRange)
{
  const glm::dquat orientation =
    orientationOf(headingOf(course.velocity), pitchOf(course.velocity), 0.0);
  for (const double time : timeRange)
  {
    flight.poses.push_back(
      { time, course.position + (time - course.time) * course.velocity, orientation });
  }
}

/// A level circle.
struct Circle
{
  Vec3 center;
  double radius;    ///< radius of the circle, m
  double bank;      ///< bank to the right, rad
  double turn;      ///< rate of the heading, rad/s
  double heading;   ///< heading at the beginning of the time range, rad
  double intervals; ///< number of intervals between poses
};

Circle circleOf(const FlightSettings& settings, const BirdSpecies& species, int bird)
{
  const BirdNumbers numbers(settings.seed, bird);
  const double speed = speedOf(numbers, species);
  const double bank = between(LeastCircleBank, MostCircleBank, numbers(DrawCircle)[0]);
  const double sense = numbers(DrawCircle)[1] < 0.5 ? -1.0 : 1.0;
  Circle circle;
  circle.radius = speed * speed / (Gravity * std::tan(bank));
  circle.bank = sense * bank;
  circle.turn = sense * speed / circle.radius;
  circle.heading = 2.0 * Pi * numbers(DrawCourse)[0];
  // The centres are uniformly distributed in the disc.
  circle.center = settings.center +
    settings.radius * std::sqrt(numbers(DrawCourse)[1]) *
      forward(2.0 * Pi * numbers(DrawPassage)[0]) +
    Vec3(0, 0, between(settings.heights[0], settings.heights[1], numbers(DrawPassage)[1]));
  // The chord of an angle a is up to r (1 - cos(a / 2)) from its arc. The angle a is at most 45
  // degrees.
  const double half = std::acos(std::max(1.0 - PathError / circle.radius, std::cos(Pi / 8.0)));
  circle.intervals = std::ceil(
    (settings.timeRange[1] - settings.timeRange[0]) * std::fabs(circle.turn) / (2.0 * half));
  return circle;
}

void fly(Flight& flight, const Circle& circle, const std::array<double, 2>& timeRange)
{
  const auto intervals = static_cast<std::size_t>(circle.intervals);
  flight.gliding = true;
  flight.poses.reserve(intervals + 1);
  for (std::size_t i = 0; i <= intervals; ++i)
  {
    const double passed = (timeRange[1] - timeRange[0]) * i / intervals;
    const double heading = circle.heading + circle.turn * passed;
    // The centre is on the inner side.
    const double outwards = circle.turn > 0.0 ? -circle.radius : circle.radius;
    flight.poses.push_back({ i < intervals ? timeRange[0] + passed : timeRange[1],
      circle.center + outwards * right(heading), orientationOf(heading, 0.0, circle.bank) });
  }
}

/// Memory of a pose here and in the arrays of two outputs, bytes.
constexpr double BytesOfPose = sizeof(Pose) + 14 * sizeof(double);

std::vector<Flight> circles(
  const FlightSettings& settings, const BirdSpecies& species, std::size_t index)
{
  double poses = 0.0;
  for (int bird = 1; bird <= settings.numberOfBirds; ++bird)
  {
    poses += circleOf(settings, species, bird).intervals + 1.0;
  }
  requireMemory(poses, "poses (NumberOfBirds, TimeRange)", poses * BytesOfPose);
  std::vector<Flight> flights;
  for (int bird = 1; bird <= settings.numberOfBirds; ++bird)
  {
    flights.push_back(flightOf({ settings.seed, static_cast<std::uint64_t>(bird) }, bird, index));
    fly(flights.back(), circleOf(settings, species, bird), settings.timeRange);
  }
  return flights;
}

/// Half the thickness of a flock, in wingspans.
double halfThickness(std::size_t birds)
{
  const double volume = birds * SpansPerBird * SpansPerBird * SpansPerBird;
  return std::cbrt(volume / (4.0 / 3.0 * Pi * FlockWidth * FlockLength));
}

std::vector<Flight> flock(
  const FlightSettings& settings, const BirdSpecies& species, std::size_t index)
{
  const auto places = flockPlaces(settings.seed, settings.numberOfBirds, species.span);
  // The random numbers of bird 0 place the flock.
  const Course middle = crossing(settings, species, 0, species.span * halfThickness(places.size()));
  const double lies = 2.0 * Pi * BirdNumbers(settings.seed, 0)(DrawWings)[0];
  std::vector<Flight> flights;
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    const int bird = static_cast<int>(i) + 1;
    flights.push_back(flightOf({ settings.seed, i + 1 }, bird, index));
    Course course = middle;
    course.position +=
      places[i].x * forward(lies) + places[i].y * right(lies) + Vec3(0.0, 0.0, places[i].z);
    fly(flights.back(), course, settings.timeRange);
  }
  return flights;
}

/// Points at least 1 apart.
class SparsePoints
{
public:
  /// Adds a point. @return false if another point is nearer than 1
  bool add(const Vec3& point)
  {
    const Vec3 cell = glm::floor(point);
    for (int neighbour = 0; neighbour < 27; ++neighbour)
    {
      const Vec3 step(neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1);
      const auto found = this->Cells.find(keyOf(cell + step));
      for (std::size_t k = 0; found != this->Cells.end() && k < found->second.size(); ++k)
      {
        const Vec3 apart = found->second[k] - point;
        if (glm::dot(apart, apart) < 1.0)
        {
          return false;
        }
      }
    }
    this->Cells[keyOf(cell)].push_back(point);
    return true;
  }

private:
  /// Key that is unique for cells within 2^20 of the origin.
  static std::uint64_t keyOf(const Vec3& cell)
  {
    const auto part = [](double value)
    { return static_cast<std::uint64_t>(static_cast<std::int64_t>(value) + (1 << 20)); };
    return part(cell.x) | part(cell.y) << 21 | part(cell.z) << 42;
  }

  std::unordered_map<std::uint64_t, std::vector<Vec3>> Cells;
};

/// Draws a point in the unit ball, denser with the squared radius. @return false if it is rejected
bool drawInBall(std::int32_t seed, std::uint64_t bird, std::uint64_t attempt, Vec3& point)
{
  const auto first = uniformPair(seed, bird, 2 * attempt, RandomPurpose::FlockPlaces);
  const auto second = uniformPair(seed, bird, 2 * attempt + 1, RandomPurpose::FlockPlaces);
  const double radius = std::cbrt(first[0]);
  const double z = between(-1.0, 1.0, second[0]);
  const double level = std::sqrt(1.0 - z * z);
  const double angle = 2.0 * Pi * second[1];
  point = radius * Vec3(level * std::cos(angle), level * std::sin(angle), z);
  return first[1] * (1.0 + BorderExcess) < 1.0 + BorderExcess * radius * radius;
}

std::string notFinite(const char* name, double value)
{
  return std::fabs(value) <= Largest
    ? std::string()
    : valueError(name, value, "a finite number of at most 1e9 in magnitude");
}

std::string checkVector(const char* name, const Vec3& value)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::string bad = notFinite(name, value[axis]);
    if (!bad.empty())
    {
      return bad;
    }
  }
  return {};
}

std::string checkRange(const char* name, const std::array<double, 2>& range, bool mayBeEmpty)
{
  std::string bad = notFinite(name, range[0]);
  bad = bad.empty() ? notFinite(name, range[1]) : bad;
  if (bad.empty() && (range[0] > range[1] || (range[0] == range[1] && !mayBeEmpty)))
  {
    std::ostringstream text;
    text.precision(17);
    text << name << " is " << range[0] << " to " << range[1] << ", expected the first "
         << (mayBeEmpty ? "not above" : "before") << " the second";
    return text.str();
  }
  return bad;
}
}

std::string checkFlights(const FlightSettings& settings)
{
  if (settings.numberOfBirds < 0 || settings.numberOfBirds > MostBirds)
  {
    return valueError("NumberOfBirds", settings.numberOfBirds, "0 to 100000");
  }
  if (!(settings.radius >= 0.0 && settings.radius <= Largest))
  {
    return valueError("Radius", settings.radius, "0 to 1e9 m");
  }
  for (const std::string& bad : { checkRange("TimeRange", settings.timeRange, false),
         checkRange("Heights", settings.heights, true), checkVector("Center", settings.center),
         checkVector("ThresholdPosition", settings.thresholdPosition),
         notFinite("ThresholdHeading", settings.thresholdHeading) })
  {
    if (!bad.empty())
    {
      return bad;
    }
  }
  return {};
}

std::vector<Flight> makeFlights(
  const FlightSettings& settings, const BirdSpecies& species, std::size_t index)
{
  if (settings.pattern == FlightPattern::Circles)
  {
    return circles(settings, species, index);
  }
  if (settings.pattern == FlightPattern::Flock)
  {
    return flock(settings, species, index);
  }
  std::vector<Flight> flights;
  for (int bird = 1; bird <= settings.numberOfBirds; ++bird)
  {
    const auto number = static_cast<std::uint64_t>(bird);
    flights.push_back(flightOf({ settings.seed, number }, bird, index));
    fly(flights.back(),
      settings.pattern == FlightPattern::Approach ? approach(settings, species, number)
                                                  : crossing(settings, species, number, 0.0),
      settings.timeRange);
  }
  return flights;
}

std::vector<Vec3> flockPlaces(std::int32_t seed, std::size_t birds, double span)
{
  const double half = halfThickness(birds);
  const Vec3 axes(FlockLength * half, FlockWidth * half, half);
  SparsePoints taken;
  std::vector<Vec3> places;
  for (std::size_t bird = 1; bird <= birds; ++bird)
  {
    Vec3 point;
    for (std::uint64_t attempt = 0;; ++attempt)
    {
      if (drawInBall(seed, bird, attempt, point) && taken.add(axes * point))
      {
        break;
      }
    }
    places.push_back(span * (axes * point));
  }
  return places;
}

void orientAlongPath(Flight& flight)
{
  std::vector<Pose>& poses = flight.poses;
  const std::size_t last = poses.size() - 1;
  const auto velocity = [&](std::size_t from, std::size_t to)
  { return (poses[to].position - poses[from].position) / (poses[to].time - poses[from].time); };
  std::vector<double> headings(poses.size(), 0.0);
  std::vector<double> pitches(poses.size(), 0.0);
  std::vector<double> banks(poses.size(), 0.0);
  bool moved = false;
  for (std::size_t i = 0; i <= last; ++i)
  {
    const Vec3 v = velocity(i > 0 ? i - 1 : 0, i < last ? i + 1 : last);
    headings[i] = i > 0 ? headings[i - 1] : 0.0;
    if (!(horizontal(v) > 0.0))
    {
      continue;
    }
    headings[i] = headingOf(v);
    pitches[i] = pitchOf(v);
    if (!moved)
    {
      std::fill(headings.begin(), headings.begin() + i, headings[i]);
      moved = true;
    }
    if (i > 0 && i < last)
    {
      const Vec3 before = velocity(i - 1, i);
      const Vec3 after = velocity(i, i + 1);
      // The angle between two horizontal directions; 0 if one direction is a zero vector.
      const double turned = std::atan2(
        before.y * after.x - before.x * after.y, before.x * after.x + before.y * after.y);
      const double seconds = 0.5 * (poses[i + 1].time - poses[i - 1].time);
      banks[i] = std::clamp(
        std::atan(horizontal(v) * turned / seconds / Gravity), -MostTrackBank, MostTrackBank);
    }
  }
  if (last > 1)
  {
    banks[0] = banks[1];
    banks[last] = banks[last - 1];
  }
  for (std::size_t i = 0; i <= last; ++i)
  {
    // q and -q are the same rotation. The quaternion nearer to the previous orientation is taken.
    const glm::dquat q = orientationOf(headings[i], pitches[i], banks[i]);
    poses[i].orientation = i > 0 && glm::dot(q, poses[i - 1].orientation) < 0.0 ? -q : q;
  }
}

double trackWingPhase(std::int32_t seed, std::size_t track)
{
  return BirdNumbers(seed, track + 1)(DrawWings)[0];
}
}
