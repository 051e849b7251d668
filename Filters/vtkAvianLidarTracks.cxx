// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarTracks.h"

#include "AvailableMemory.h"
#include "BirdTables.h"
#include "Flight.h"
#include "GeodeticFrame.h"
#include "Table.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBirds.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarText.h"

#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Flight;
using avianlidar::Pose;
using avianlidar::Vec3;

/// Memory of a bird in the outputs, without its poses, bytes (measured).
constexpr double BytesOfBird = 16000.0;

/// Distance from the scene's origin, m. If all birds are farther away, the warning names Origin.
constexpr double FarAway = 1e5;

using KnownSpecies = std::vector<avianlidar::BirdSpecies>;

Vec3 VectorOf(const double values[3])
{
  return { values[0], values[1], values[2] };
}

/// Array with one row for each wing.
vtkSmartPointer<vtkDoubleArray> WingRows(
  const Arrays::Name& name, const std::vector<std::vector<double>>& rows)
{
  auto array = Arrays::Make<vtkDoubleArray>(
    name, static_cast<vtkIdType>(rows.size()), static_cast<int>(rows[0].size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    array->SetTypedTuple(static_cast<vtkIdType>(i), rows[i].data());
  }
  return array;
}

/// Tracks given as lines of the input.
class LineTracks
{
public:
  LineTracks(vtkPolyData* input, const KnownSpecies& known)
    : Input(input)
    , Known(known)
    , Times(input->GetPointData()->GetArray(Arrays::Time.name))
    , CellSpecies(StringsOf(input->GetCellData(), "cell array"))
    , FieldSpecies(StringsOf(input->GetFieldData(), "field data"))
  {
    vtkAvianLidarWithin("Input port 0: ",
      [&]()
      {
        Arrays::RequireNumeric(input->GetPointData(), Arrays::Time, "point array");
        vtkAvianLidarRequire(
          this->Times ? "" : "has no point array 'time', expected the times of its points in s");
        Arrays::RequireShape(this->Times, "point array", 1, input->GetNumberOfPoints());
        const bool byCell = this->CellSpecies != nullptr;
        vtkStringArray* names = byCell ? this->CellSpecies : this->FieldSpecies;
        const vtkIdType wanted = byCell ? input->GetNumberOfCells() : input->GetNumberOfLines();
        const vtkIdType count = names ? names->GetNumberOfValues() : wanted;
        vtkAvianLidarRequire(count == wanted || (!byCell && count == 1)
            ? ""
            : (byCell ? "cell array" : "field data") + std::string(" 'species' has ") +
              std::to_string(count) + " values, expected " + (byCell ? "" : "1 or ") +
              std::to_string(wanted));
      });
  }

  bool HasSpecies() const { return this->CellSpecies || this->FieldSpecies; }

  /// @param species index of the species of all lines, if the input does not name species
  std::vector<Flight> Read(std::size_t species, int seed)
  {
    std::vector<Flight> flights;
    auto lines =
      vtkSmartPointer<vtkCellArrayIterator>::Take(this->Input->GetLines()->NewIterator());
    for (lines->GoToFirstCell(); !lines->IsDoneWithTraversal(); lines->GoToNextCell())
    {
      const vtkIdType line = lines->GetCurrentCellId();
      vtkIdType size = 0;
      const vtkIdType* points = nullptr;
      lines->GetCurrentCell(size, points);
      Flight flight;
      flight.number = std::to_string(line + 1);
      flight.species = this->HasSpecies() ? this->SpeciesOf(line) : species;
      flight.wingPhase = avianlidar::trackWingPhase(seed, static_cast<std::size_t>(line));
      if (size < 2)
      {
        Fail(line, "has " + std::to_string(size) + " points, expected at least two");
      }
      for (vtkIdType i = 0; i < size; ++i)
      {
        this->AddPose(flight, line, points[i]);
      }
      avianlidar::orientAlongPath(flight);
      flights.push_back(std::move(flight));
    }
    return flights;
  }

private:
  static vtkStringArray* StringsOf(vtkFieldData* data, const std::string& kind)
  {
    vtkAbstractArray* array = data->GetAbstractArray(Arrays::Species.name);
    auto* strings = vtkStringArray::SafeDownCast(array);
    if (array && (!strings || strings->GetNumberOfComponents() != 1))
    {
      throw std::runtime_error("Input port 0: " + kind +
        " 'species' does not have one text per line, expected names of species");
    }
    return strings;
  }

  [[noreturn]] static void Fail(vtkIdType line, const std::string& message)
  {
    throw std::runtime_error("Input port 0: line " + std::to_string(line) + " " + message);
  }

  std::size_t SpeciesOf(vtkIdType line) const
  {
    vtkStringArray* names = this->CellSpecies ? this->CellSpecies : this->FieldSpecies;
    const vtkIdType at = this->CellSpecies ? this->Input->GetNumberOfVerts() + line
                                           : (names->GetNumberOfValues() == 1 ? 0 : line);
    try
    {
      return avianlidar::findSpecies(this->Known, names->GetValue(at));
    }
    catch (const std::runtime_error& error)
    {
      Fail(line, std::string("has a species that ") + error.what());
    }
  }

  void AddPose(Flight& flight, vtkIdType line, vtkIdType point) const
  {
    Pose pose;
    double p[3];
    this->Input->GetPoint(point, p);
    pose.position = VectorOf(p);
    pose.time = this->Times->GetComponent(point, 0);
    for (const double value : { p[0], p[1], p[2], pose.time })
    {
      if (!(std::fabs(value) <= avianlidar::LargestOfFlight))
      {
        Fail(line,
          "has at point " + std::to_string(point) +
            " a coordinate or a time ('time') that is not finite or beyond 1e9, expected m and s");
      }
    }
    if (!flight.poses.empty() && !(pose.time > flight.poses.back().time))
    {
      Fail(line,
        "has at point " + std::to_string(point) + " a 'time' that is " + std::to_string(pose.time) +
          " s, expected more than " + std::to_string(flight.poses.back().time) +
          ", the time of the point before");
    }
    flight.poses.push_back(pose);
  }

  vtkPolyData* Input;
  const KnownSpecies& Known;
  vtkDataArray* Times;
  vtkStringArray* CellSpecies;
  vtkStringArray* FieldSpecies;
};

/// Makes blocks. Blocks of one species share their common data.
class Movers
{
public:
  Movers(const KnownSpecies& known, double reflectance)
    : Known(known)
    , Reflectance(reflectance)
  {
  }

  vtkSmartPointer<vtkPolyData> BlockOf(const Flight& flight, int objectId, const std::string& name)
  {
    auto block = vtkSmartPointer<vtkPolyData>::New();
    block->ShallowCopy(this->CommonTo(flight));
    vtkAvianLidarBirds::SetObject(block, objectId, name);
    vtkFieldData* fields = block->GetFieldData();
    const auto count = static_cast<vtkIdType>(flight.poses.size());
    auto times = Arrays::Make<vtkDoubleArray>(Arrays::PoseTime, count);
    auto positions = Arrays::Make<vtkDoubleArray>(Arrays::PosePosition, count, 3);
    auto orientations = Arrays::Make<vtkDoubleArray>(Arrays::PoseOrientation, count, 4);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const Pose& pose = flight.poses[static_cast<std::size_t>(i)];
      const glm::dquat& q = pose.orientation;
      times->SetValue(i, pose.time);
      positions->SetTuple3(i, pose.position.x, pose.position.y, pose.position.z);
      orientations->SetTuple4(i, q.w, q.x, q.y, q.z);
    }
    fields->AddArray(times);
    fields->AddArray(positions);
    fields->AddArray(orientations);
    if (!flight.gliding)
    {
      fields->AddArray(WingRows(Arrays::FlapPhase, { { flight.wingPhase }, { flight.wingPhase } }));
    }
    return block;
  }

private:
  vtkPolyData* CommonTo(const Flight& flight)
  {
    vtkSmartPointer<vtkPolyData>& common = this->Common[{ flight.species, flight.gliding }];
    if (!common)
    {
      const avianlidar::BirdSpecies& species = this->Known[flight.species];
      const avianlidar::BirdShape shape(species);
      common = vtkAvianLidarBirds::Surface(
        shape, flight.gliding ? avianlidar::wingAngle(0.0, true) : 0.0, this->Reflectance);
      Arrays::SetFieldStrings(common->GetFieldData(), Arrays::Species, { species.name });
      if (flight.gliding)
      {
        common->GetCellData()->RemoveArray(Arrays::Part.name); // gliding wings do not flap
      }
      else
      {
        AddFlaps(common->GetFieldData(), species, shape);
      }
    }
    return common;
  }

  /// Adds the arrays of flapping wings. Row 0 is the left wing (part 1). Row 1 is the right wing.
  static void AddFlaps(vtkFieldData* fields, const avianlidar::BirdSpecies& species,
    const avianlidar::BirdShape& shape)
  {
    const double side = 0.5 * shape.bodyDiameter;
    const double amplitude = avianlidar::wingAngle(0.25, false);
    const double frequency = avianlidar::wingbeatFrequency(species);
    fields->AddArray(WingRows(Arrays::FlapHinge, { { -side, 0.0, 0.0 }, { side, 0.0, 0.0 } }));
    fields->AddArray(WingRows(Arrays::FlapAxis, { { 0.0, 1.0, 0.0 }, { 0.0, -1.0, 0.0 } }));
    fields->AddArray(WingRows(Arrays::FlapAmplitude, { { amplitude }, { amplitude } }));
    fields->AddArray(WingRows(Arrays::FlapFrequency, { { frequency }, { frequency } }));
  }

  const KnownSpecies& Known;
  double Reflectance;
  std::map<std::pair<std::size_t, bool>, vtkSmartPointer<vtkPolyData>> Common;
};

/// Trails of all flights.
class Trails
{
public:
  Trails(const KnownSpecies& known, const std::vector<Flight>& flights)
    : Known(known)
  {
    vtkIdType count = 0;
    for (const Flight& flight : flights)
    {
      count += static_cast<vtkIdType>(flight.poses.size());
    }
    this->Points = Arrays::MakePoints(count);
    this->Times = Arrays::Make<vtkDoubleArray>(Arrays::Time, count);
  }

  void Add(const Flight& flight, int objectId)
  {
    this->Lines->InsertNextCell(static_cast<int>(flight.poses.size()));
    for (const Pose& pose : flight.poses)
    {
      this->Points->SetPoint(this->Next, pose.position.x, pose.position.y, pose.position.z);
      this->Times->SetValue(this->Next, pose.time);
      this->Lines->InsertCellPoint(this->Next++);
    }
    this->ObjectIds->InsertNextValue(objectId);
    this->SpeciesIds->InsertNextValue(this->IdOf(flight.species));
  }

  void Fill(vtkPolyData* output)
  {
    output->SetPoints(this->Points);
    output->SetLines(this->Lines);
    output->GetPointData()->AddArray(this->Times);
    output->GetCellData()->AddArray(this->ObjectIds);
    output->GetCellData()->AddArray(this->SpeciesIds);
    std::vector<std::string> names(this->Known.size());
    for (std::size_t i = 0; i < names.size(); ++i)
    {
      names[this->IdOf(i)] = this->Known[i].name;
    }
    Arrays::SetFieldStrings(output->GetFieldData(), Arrays::SpeciesNames, names);
  }

private:
  /// Built-in species have the same ids with every table of own species, which are first in Known.
  int IdOf(std::size_t species) const
  {
    return static_cast<int>((species + this->BuiltIn) % this->Known.size());
  }

  const KnownSpecies& Known;
  vtkSmartPointer<vtkPoints> Points;
  vtkSmartPointer<vtkDoubleArray> Times;
  vtkNew<vtkCellArray> Lines;
  vtkSmartPointer<vtkIntArray> ObjectIds = Arrays::Make<vtkIntArray>(Arrays::ObjectId);
  vtkSmartPointer<vtkIntArray> SpeciesIds = Arrays::Make<vtkIntArray>(Arrays::SpeciesId);
  const std::size_t BuiltIn = vtkAvianLidarBirds::BuiltInSpecies().size();
  vtkIdType Next = 0;
};
}

/// Flights of one execution.
class vtkAvianLidarTracks::vtkFlights
{
public:
  explicit vtkFlights(vtkAvianLidarTracks* self)
    : Known(vtkAvianLidarBirds::KnownSpecies(self->SpeciesFileName))
    , Self(self)
  {
  }

  void Make(vtkPolyData* input)
  {
    if (this->Self->Pattern == PATTERN_FILE)
    {
      this->Read();
    }
    else if (this->Self->Pattern == PATTERN_LINES)
    {
      this->Take(input);
    }
    else
    {
      this->Flights =
        avianlidar::makeFlights(this->Settings(), this->Known[this->Own()], this->Own());
    }
  }

  const KnownSpecies Known;
  std::vector<Flight> Flights;

private:
  /// Index of the species given by the property Species.
  std::size_t Own() const
  {
    const std::string usual = this->Self->Pattern == PATTERN_FLOCK ? "starling" : "herring gull";
    return vtkAvianLidarBirds::FindSpecies(
      this->Known, this->Self->Species.empty() ? usual : this->Self->Species);
  }

  avianlidar::FlightSettings Settings() const
  {
    avianlidar::FlightSettings settings;
    settings.pattern = static_cast<avianlidar::FlightPattern>(this->Self->Pattern);
    settings.numberOfBirds = this->Self->NumberOfBirds;
    settings.seed = this->Self->Seed;
    settings.timeRange = { this->Self->TimeRange[0], this->Self->TimeRange[1] };
    settings.center = VectorOf(this->Self->Center);
    settings.radius = this->Self->Radius;
    settings.heights = { this->Self->Heights[0], this->Self->Heights[1] };
    settings.thresholdPosition = VectorOf(this->Self->ThresholdPosition);
    settings.thresholdHeading = this->Self->ThresholdHeading;
    vtkAvianLidarRequire(avianlidar::checkFlights(settings));
    avianlidar::requireMemory(
      settings.numberOfBirds, "birds (NumberOfBirds)", settings.numberOfBirds * BytesOfBird);
    return settings;
  }

  void Read()
  {
    const double* origin = this->Self->Origin;
    vtkAvianLidarRequire(
      this->Self->FileName.empty() ? "FileName is empty, expected a file of tracks" : "");
    this->Flights =
      avianlidar::readFlights(avianlidar::textOfFile("FileName", this->Self->FileName),
        this->Self->FileName, this->Known, { origin[0], origin[1], origin[2] }, this->Self->Seed);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Flight& flight : this->Flights)
    {
      for (const Pose& pose : flight.poses)
      {
        nearest = std::min(nearest, std::sqrt(glm::dot(pose.position, pose.position)));
      }
    }
    if (!this->Flights.empty() && nearest > FarAway)
    {
      vtkWarningWithObjectMacro(
        this->Self, << "FileName " << vtkAvianLidarText(this->Self->FileName)
                    << ": all birds are at least " << std::llround(nearest / 1e3)
                    << " km from the scene's origin. Longitude and latitude need "
                    << "Origin, now latitude " << origin[0] << ", longitude " << origin[1]
                    << ". x and y are metres from the origin.");
    }
  }

  void Take(vtkPolyData* input)
  {
    vtkAvianLidarRequire(input ? ""
                               : "Input port 0 has no connection, expected lines with the "
                                 "point array 'time', as Pattern is Lines");
    if (input->GetNumberOfLines() > 0)
    {
      LineTracks lines(input, this->Known);
      this->Flights = lines.Read(lines.HasSpecies() ? 0 : this->Own(), this->Self->Seed);
    }
    else
    {
      vtkAvianLidarRequire(input->GetNumberOfPoints() > 0
          ? "Input port 0 has points but no lines, expected lines"
          : "");
    }
  }

  vtkAvianLidarTracks* Self;
};

vtkStandardNewMacro(vtkAvianLidarTracks);

//------------------------------------------------------------------------------
vtkAvianLidarTracks::vtkAvianLidarTracks()
{
  this->SetNumberOfInputPorts(1);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
int vtkAvianLidarTracks::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Set(INPUT_IS_OPTIONAL(), 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarTracks::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkMultiBlockDataSet" : "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarTracks::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkAvianLidarRequire(
        avianlidar::rangeError("Pattern", this->Pattern, PATTERN_CROSSINGS, PATTERN_LINES,
          "0 (crossings), 1 (circles), 2 (flock), 3 (approach), 4 (file) or 5 (lines)"));
      const double* origin = this->Origin;
      vtkAvianLidarRequire(
        avianlidar::GeodeticFrame::checkOrigin(origin[0], origin[1], origin[2]), "Origin: ");
      vtkAvianLidarBirds::CheckReflectance(this->Reflectance);
      vtkFlights made(this);
      made.Make(vtkPolyData::GetData(inputVector[0]));
      const std::vector<Flight>& flights = made.Flights;
      const std::size_t most = std::numeric_limits<int>::max() - flights.size();
      vtkAvianLidarRequire(avianlidar::rangeError("FirstObjectId", this->FirstObjectId, 0.0,
        static_cast<double>(most), "0 to " + std::to_string(most) + " for this many birds"));
      auto* blocks = vtkMultiBlockDataSet::GetData(outputVector, 0);
      blocks->SetNumberOfBlocks(static_cast<unsigned int>(flights.size()));
      Movers movers(made.Known, this->Reflectance);
      Trails trails(made.Known, flights);
      for (std::size_t i = 0; i < flights.size(); ++i)
      {
        const int objectId = this->FirstObjectId + static_cast<int>(i);
        const std::string name =
          vtkAvianLidarText(made.Known[flights[i].species].name + " " + flights[i].number);
        const auto block = static_cast<unsigned int>(i);
        blocks->SetBlock(block, movers.BlockOf(flights[i], objectId, name));
        blocks->GetMetaData(block)->Set(vtkCompositeDataSet::NAME(), name);
        trails.Add(flights[i], objectId);
        if (i % 1024 == 1023)
        {
          this->UpdateProgress(static_cast<double>(i) / static_cast<double>(flights.size()));
          vtkAvianLidarAbort::StopIfWanted(this);
        }
      }
      trails.Fill(vtkPolyData::GetData(outputVector, 1));
    });
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarTracks::GetKnownSpecies()
{
  return vtkAvianLidarBirds::NamesOfSpecies(this->SpeciesFileName);
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarTracks, Pattern, FileName, Origin, Species,
  SpeciesFileName, NumberOfBirds, Seed, TimeRange, Center, Radius, Heights, ThresholdPosition,
  ThresholdHeading, Reflectance, FirstObjectId, ErrorsAsData);
