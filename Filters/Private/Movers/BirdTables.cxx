// SPDX-License-Identifier: BSD-3-Clause
#include "BirdTables.h"

#include "GeodeticFrame.h"
#include "Table.h"

#include <sstream>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr double Largest = LargestOfFlight;

BirdSpecies speciesOf(const TableLine& line)
{
  BirdSpecies species;
  species.name = line.text(0);
  if (species.name.empty())
  {
    line.fail("species has no name");
  }
  species.mass = line.number(1, "mass", 1e-3, 100.0);
  species.length = line.number(2, "length", 0.01, 10.0);
  species.span = line.number(3, "span", 0.01, 10.0);
  species.wingArea = line.number(4, "wing area", 1e-5, 10.0);
  species.passerine = line.text(5) == "yes";
  if (!species.passerine && line.text(5) != "no")
  {
    line.fail("passerine is '" + line.text(5) + "', expected yes or no");
  }
  species.airspeed = line.number(6, "airspeed", 0.1, 100.0);
  if (!(BirdShape(species).wingLength > 0.0))
  {
    line.fail("the span is smaller than the body of this mass is wide");
  }
  if (BirdShape(species).wingChord > species.length)
  {
    line.fail("the wings are broader than the bird is long: see wing area and span");
  }
  return species;
}

/// Reads the rows of a table of tracks.
class TrackRows
{
public:
  TrackRows(const std::vector<BirdSpecies>& known, std::int32_t seed)
    : Known(known)
    , Seed(seed)
  {
  }

  void setOrigin(const std::array<double, 3>& origin)
  {
    this->Geodesy.setOrigin(origin[0], origin[1], origin[2]);
  }

  void add(const TableLine& line, bool geodetic)
  {
    Flight& flight = this->flightOf(line);
    Pose pose;
    pose.time = line.number(2, "time", -Largest, Largest);
    pose.position = geodetic
      ? this->geodeticPosition(line)
      : Vec3(line.number(3, "x", -Largest, Largest), line.number(4, "y", -Largest, Largest),
          line.number(5, "z", -Largest, Largest));
    if (!flight.poses.empty() && !(pose.time > flight.poses.back().time))
    {
      std::ostringstream before;
      before.precision(17);
      before << flight.poses.back().time;
      line.fail("time is '" + line.text(2) + "', expected more than " + before.str() +
        ", the time before of id '" + flight.number + "'");
    }
    flight.poses.push_back(pose);
  }

  std::vector<Flight> Flights;

private:
  Flight& flightOf(const TableLine& line)
  {
    if (line.text(0).empty())
    {
      line.fail("id is empty, expected a name or a number");
    }
    const std::size_t species = this->speciesOf(line);
    const auto [place, isNew] = this->Ids.try_emplace(line.text(0), this->Flights.size());
    if (isNew)
    {
      Flight flight;
      flight.number = line.text(0);
      flight.species = species;
      flight.wingPhase = trackWingPhase(this->Seed, this->Flights.size());
      this->Flights.push_back(flight);
    }
    Flight& flight = this->Flights[place->second];
    if (flight.species != species)
    {
      line.fail("species is '" + line.text(1) + "', expected '" + this->Known[flight.species].name +
        "', as id '" + flight.number + "' has it before");
    }
    return flight;
  }

  std::size_t speciesOf(const TableLine& line) const
  try
  {
    return findSpecies(this->Known, line.text(1));
  }
  catch (const std::runtime_error& error)
  {
    line.fail(std::string("species ") + error.what());
  }

  Vec3 geodeticPosition(const TableLine& line) const
  {
    const auto p = this->Geodesy.convert(Frame::Geodetic, Frame::ENU,
      { line.number(3, "longitude", -360.0, 360.0), line.number(4, "latitude", -90.0, 90.0),
        line.number(5, "height", -Largest, Largest) });
    return { p[0], p[1], p[2] };
  }

  const std::vector<BirdSpecies>& Known;
  std::int32_t Seed;
  GeodeticFrame Geodesy;
  std::unordered_map<std::string, std::size_t> Ids;
};
}

std::vector<BirdSpecies> readSpecies(const std::string& text, const std::string& file)
{
  std::vector<BirdSpecies> all;
  readTable(text, file,
    { "species,mass [kg],length [m],span [m],wing area [m2],passerine,airspeed [m/s]" },
    [&](const TableLine& line, std::size_t) { all.push_back(speciesOf(line)); });
  if (all.empty())
  {
    throw std::runtime_error(file + ": holds no species");
  }
  return all;
}

std::vector<Flight> readFlights(const std::string& text, const std::string& file,
  const std::vector<BirdSpecies>& known, const std::array<double, 3>& origin, std::int32_t seed)
{
  TrackRows rows(known, seed);
  readTable(text, file, { "id,species,time,x,y,z", "id,species,time,longitude,latitude,height" },
    [&](const TableLine& line, std::size_t header)
    {
      if (header == 1 && rows.Flights.empty())
      {
        rows.setOrigin(origin);
      }
      rows.add(line, header == 1);
    });
  for (Flight& flight : rows.Flights)
  {
    if (flight.poses.size() < 2)
    {
      throw std::runtime_error(
        file + ": id '" + flight.number + "' has one time, expected at least two");
    }
    orientAlongPath(flight);
  }
  return std::move(rows.Flights);
}
}
