// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarClutterFilter.h"

#include "ClutterMap.h"
#include "Figures.h"
#include "ScanBeams.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"
#include "vtkAvianLidarContent.h"
#include "vtkAvianLidarGather.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarScanStream.h"

#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkMultiProcessStream.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::ClutterCell;
using avianlidar::ClutterGrid;
using avianlidar::ClutterMap;

constexpr char ScanPort[] = "input port 0 (scan): ";
constexpr char TablePort[] = "input port 1 (table): ";

// Settings and inputs that must not change while a memory is used.
struct Setup
{
  ClutterGrid Grid;
  double Window = 0.0;
  bool Learning = true;
  double Position[3] = { 0.0, 0.0, 0.0 };
  std::uint64_t Table = 0; ///< hash of the table's content, 0 without a table

  bool operator==(const Setup& other) const
  {
    return this->Grid.rangeStep == other.Grid.rangeStep &&
      this->Grid.azimuthStep == other.Grid.azimuthStep &&
      this->Grid.elevationStep == other.Grid.elevationStep && this->Window == other.Window &&
      this->Learning == other.Learning &&
      std::equal(this->Position, this->Position + 3, other.Position) && this->Table == other.Table;
  }
};

// Sets the position on a rank without points to the position of the first rank with points.
void SharePosition(const vtkAvianLidarRanks& ranks, bool hasPoints, double position[3])
{
  vtkMultiProcessStream mine;
  mine << (hasPoints ? 1 : 0) << position[0] << position[1] << position[2];
  for (vtkMultiProcessStream& stream : ranks.Gather(mine))
  {
    int has = 0;
    double read[3];
    stream >> has >> read[0] >> read[1] >> read[2];
    if (has != 0 && !hasPoints)
    {
      std::copy(read, read + 3, position);
      return;
    }
  }
}

// Key of the cell of each point.
std::vector<ClutterMap::Key> KeysOf(vtkPointSet* cloud, const Setup& setup)
{
  std::vector<ClutterMap::Key> keys(static_cast<std::size_t>(cloud->GetNumberOfPoints()));
  vtkPoints* points = cloud->GetPoints();
  auto* const doubles = vtkDoubleArray::SafeDownCast(points ? points->GetData() : nullptr);
  for (std::size_t i = 0; i < keys.size(); ++i)
  {
    double copied[3];
    const double* const p = doubles ? doubles->GetPointer(0) + 3 * i : copied;
    if (!doubles)
    {
      points->GetPoint(static_cast<vtkIdType>(i), copied);
    }
    const std::string wrong = avianlidar::checkPosition({ p[0], p[1], p[2] });
    if (!wrong.empty())
    {
      vtkAvianLidarRequire(wrong, std::string(ScanPort) + "point " + std::to_string(i) + ": ");
    }
    keys[i] = ClutterMap::keyOf(
      setup.Grid, { p[0] - setup.Position[0], p[1] - setup.Position[1], p[2] - setup.Position[2] });
  }
  return keys;
}

// Reads the map that a table holds.
ClutterMap ReadTable(vtkPolyData* table, const ClutterMap& empty)
{
  vtkFieldData* fields = table->GetFieldData();
  const ClutterGrid& grid = empty.grid();
  for (const auto& [name, expected] : { std::pair(Arrays::ClutterRangeStep, grid.rangeStep),
         std::pair(Arrays::ClutterAzimuthStep, grid.azimuthStep),
         std::pair(Arrays::ClutterElevationStep, grid.elevationStep) })
  {
    double step = 0.0;
    vtkAvianLidarRequire(Arrays::GetFieldValue(fields, name, step)
        ? ""
        : std::string("field data '") + name.name + "' is not one finite number");
    const double rounding = 1e-6 * expected; // of numbers in text files
    vtkAvianLidarRequire(avianlidar::rangeError(name.name, step, expected - rounding,
      expected + rounding, "the step of the filter, " + std::to_string(expected)));
  }
  double scans = 0.0;
  const bool known = Arrays::GetFieldValue(fields, Arrays::LearnedScans, scans);
  vtkAvianLidarRequire(known && Arrays::IsInt(scans) && scans >= 0.0
      ? ""
      : "field data 'learned_scans' is not a whole number of at least 0");
  const vtkIdType size = table->GetNumberOfPoints();
  vtkDataArray* persistence = table->GetPointData()->GetArray(Arrays::ClutterProbability.name);
  vtkDataArray* indices = table->GetPointData()->GetArray(Arrays::ClutterCell.name);
  const std::pair<vtkDataArray*, int> arrays[] = { { persistence, 1 }, { indices, 3 } };
  for (const auto& [array, components] : arrays)
  {
    vtkAvianLidarRequire(size == 0 || array
        ? ""
        : "point arrays 'clutter_probability' or 'clutter_cell' are missing, expected both");
    Arrays::RequireShape(array, "point array", components, size);
  }
  std::vector<ClutterMap::Key> keys(static_cast<std::size_t>(size));
  std::vector<double> shares(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
  {
    double index[3];
    indices->GetTuple(static_cast<vtkIdType>(i), index);
    shares[i] = persistence->GetComponent(static_cast<vtkIdType>(i), 0);
    const bool whole = std::all_of(index, index + 3, Arrays::IsInt);
    const ClutterCell cell = whole ? ClutterCell{ static_cast<int>(index[0]),
      static_cast<int>(index[1]), static_cast<int>(index[2]) }
                                   : ClutterCell{ -1, 0, 0 };
    const bool isCell = ClutterMap::holds(grid, cell);
    if (!isCell || !(shares[i] >= 0.0 && shares[i] <= 1.0))
    {
      vtkAvianLidarRequire(isCell
          ? avianlidar::valueError("clutter_probability", shares[i], "0 to 1")
          : "'clutter_cell' is not a cell of the grid",
        "point " + std::to_string(i) + ": ");
    }
    keys[i] = ClutterMap::keyOf(cell);
  }
  return empty.restored(keys, shares, static_cast<int>(scans));
}

std::uint64_t HashOfTable(vtkPolyData* table)
{
  if (!table)
  {
    return 0;
  }
  std::uint64_t hash = 1;
  for (const Arrays::Name& name : { Arrays::ClutterProbability, Arrays::ClutterCell })
  {
    hash = vtkAvianLidarContent::HashOf(table->GetPointData()->GetArray(name.name), hash);
  }
  for (const Arrays::Name& name : { Arrays::LearnedScans, Arrays::ClutterRangeStep,
         Arrays::ClutterAzimuthStep, Arrays::ClutterElevationStep })
  {
    hash = vtkAvianLidarContent::HashOf(table->GetFieldData()->GetArray(name.name), hash);
  }
  return hash;
}

// Writes the cells of a map as vertices.
void WriteTable(const ClutterMap& map, const double position[3], vtkPolyData* output)
{
  const auto size = static_cast<vtkIdType>(map.keys().size());
  auto points = Arrays::MakePoints(size);
  auto persistence = Arrays::Make<vtkDoubleArray>(Arrays::ClutterProbability, size);
  auto indices = Arrays::Make<vtkIntArray>(Arrays::ClutterCell, size, 3);
  const std::vector<avianlidar::Vec3> middles = map.middles();
  double* place = vtkDoubleArray::SafeDownCast(points->GetData())->GetPointer(0);
  for (vtkIdType i = 0; i < size; ++i)
  {
    const auto k = static_cast<std::size_t>(i);
    const ClutterCell cell = ClutterMap::cellOf(map.keys()[k]);
    const avianlidar::Vec3& middle = middles[k];
    for (int axis = 0; axis < 3; ++axis)
    {
      *place++ = position[axis] + middle[axis];
    }
    persistence->SetValue(i, map.persistence(k));
    indices->SetTypedComponent(i, 0, cell.azimuth);
    indices->SetTypedComponent(i, 1, cell.elevation);
    indices->SetTypedComponent(i, 2, cell.range);
  }
  output->SetPoints(points);
  output->SetVerts(vtkAvianLidarMakeCells(size, 1));
  output->GetPointData()->AddArray(persistence);
  output->GetPointData()->AddArray(indices);
}
}

// Maps are shared, so that each execution can change a copy and drop the copy after an error.
struct vtkAvianLidarClutterFilter::Memory
{
  Setup Of;
  double Position[3]; ///< sensor's position for the present scan
  vtkAvianLidarScanStream Stream;
  std::shared_ptr<const ClutterMap> Before; ///< map without the last scan
  std::shared_ptr<const ClutterMap> With;   ///< map with the last scan
};

vtkStandardNewMacro(vtkAvianLidarClutterFilter);
vtkAvianLidarCxxControllerMacro(vtkAvianLidarClutterFilter);

//------------------------------------------------------------------------------
vtkAvianLidarClutterFilter::vtkAvianLidarClutterFilter()
  : Kept(std::make_unique<Memory>())
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarClutterFilter::~vtkAvianLidarClutterFilter() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarClutterFilter::Forget()
{
  *this->Kept = Memory();
  this->Modified();
}

//------------------------------------------------------------------------------
int vtkAvianLidarClutterFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkPointSet" : "vtkPolyData");
  if (port == 1)
  {
    info->Set(INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarClutterFilter::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPointSet" : "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarClutterFilter::RequestDataObject(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPointSet* input = vtkPointSet::GetData(inputVector[0]);
  if (!input)
  {
    return 0;
  }
  vtkPointSet* scan = vtkPointSet::GetData(outputVector, 0);
  if (!scan || !scan->IsA(input->GetClassName()))
  {
    auto created = vtkSmartPointer<vtkPointSet>::Take(input->NewInstance());
    outputVector->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), created);
  }
  if (!vtkPolyData::GetData(outputVector, 1))
  {
    vtkNew<vtkPolyData> table;
    outputVector->GetInformationObject(1)->Set(vtkDataObject::DATA_OBJECT(), table);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarClutterFilter::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkAvianLidarRanks(this->Controller, request, outputVector).RequestPiece(inputVector[0]);
  vtkAvianLidarRanks::RequestAll(inputVector[1]); // each rank needs the whole table
  return 1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarClutterFilter::CheckProperties() const
{
  using avianlidar::rangeError;
  vtkAvianLidarRequire(rangeError(
    "ClutterThreshold", this->ClutterThreshold, avianlidar::AboveZero, 1.0, "above 0, at most 1"));
  for (const auto& [name, value] : { std::pair("RangeTolerance", this->RangeTolerance),
         std::pair("AngularTolerance", this->AngularTolerance) })
  {
    vtkAvianLidarRequire(rangeError(name, value, 0, ClutterMap::MostTolerance, "0 to 10 cells"));
  }
  vtkAvianLidarRequire(rangeError("WarmUp", this->WarmUp, 0, 100000, "0 to 100,000 scans"));
  vtkAvianLidarRequire(avianlidar::checkPosition({ this->SensorPosition[0], this->SensorPosition[1],
                         this->SensorPosition[2] }),
    "SensorPosition: ");
  vtkAvianLidarRequire(
    ClutterMap::check({ this->RangeStep, this->AzimuthStep, this->ElevationStep }, this->Window));
}

//------------------------------------------------------------------------------
void vtkAvianLidarClutterFilter::Advance(vtkDataObject* cloud, vtkPolyData* table, Memory& memory)
{
  this->CheckProperties();
  vtkAvianLidarRequire(this->Learning || table
      ? ""
      : "Learning is off and input port 1 (table) is not connected, expected Learning or a table");
  Setup setup;
  setup.Grid = { this->RangeStep, this->AzimuthStep, this->ElevationStep };
  setup.Window = this->Window;
  setup.Learning = this->Learning;
  std::copy(memory.Position, memory.Position + 3, setup.Position);
  setup.Table = HashOfTable(table);
  const double time = vtkAvianLidarWithin(ScanPort, [&]() { return memory.Stream.TimeOf(cloud); });
  const bool goesOn = memory.Stream.Begun() && memory.Of == setup;
  const bool back = goesOn && time < memory.Stream.Time();
  if (!goesOn || back)
  {
    const ClutterMap empty(setup.Grid, setup.Window);
    memory.Before = std::make_shared<const ClutterMap>(
      !table ? empty : vtkAvianLidarWithin(TablePort, [&]() { return ReadTable(table, empty); }));
  }
  else if (time > memory.Stream.Time())
  {
    memory.Before = memory.With;
  }
  if (back)
  {
    vtkWarningMacro("The time goes back from " << avianlidar::figures(memory.Stream.Time(), 15)
                                               << " s to " << avianlidar::figures(time, 15)
                                               << " s: the memory is emptied.");
  }
  memory.Of = setup;
  memory.Stream.Accept(cloud, time);
}

//------------------------------------------------------------------------------
void vtkAvianLidarClutterFilter::AddSettings(const Memory& memory, vtkFieldData* fields) const
{
  for (const auto& [name, value] : { std::pair(Arrays::ClutterWindow, this->Window),
         std::pair(Arrays::ClutterThreshold, this->ClutterThreshold),
         std::pair(Arrays::ClutterRangeStep, this->RangeStep),
         std::pair(Arrays::ClutterAzimuthStep, this->AzimuthStep),
         std::pair(Arrays::ClutterElevationStep, this->ElevationStep) })
  {
    Arrays::SetFieldValue(fields, name, value);
  }
  for (const auto& [name, value] : { std::pair(Arrays::LearnedScans, memory.With->scans()),
         std::pair(Arrays::ClutterRangeTolerance, this->RangeTolerance),
         std::pair(Arrays::ClutterAngularTolerance, this->AngularTolerance),
         std::pair(Arrays::ClutterWarmUp, this->WarmUp),
         std::pair(Arrays::ClutterLearning, this->Learning ? 1 : 0) })
  {
    Arrays::SetFieldInteger(fields, name, value);
  }
  Arrays::SetFieldVector(fields, Arrays::Position, memory.Of.Position);
}

//------------------------------------------------------------------------------
void vtkAvianLidarClutterFilter::Classify(
  const Memory& memory, const std::vector<std::uint64_t>& keys, vtkPointSet* output) const
{
  const std::vector<double> found =
    memory.Before->probabilities(keys, this->RangeTolerance, this->AngularTolerance);
  const bool warmingUp = this->Learning && memory.Before->scans() < this->WarmUp;
  auto probability = Arrays::MakeOf<vtkDoubleArray>(Arrays::ClutterProbability, found);
  auto clutter =
    Arrays::Make<vtkUnsignedCharArray>(Arrays::IsClutter, static_cast<vtkIdType>(found.size()));
  std::transform(found.begin(), found.end(), clutter->GetPointer(0),
    [&](double value) -> unsigned char
    { return warmingUp || value >= this->ClutterThreshold ? 1 : 0; });
  output->GetPointData()->AddArray(probability);
  output->GetPointData()->AddArray(clutter);
}

//------------------------------------------------------------------------------
int vtkAvianLidarClutterFilter::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks)
    {
      vtkPointSet* cloud = vtkPointSet::GetData(inputVector[0]);
      Memory memory = *this->Kept; // copy, so that an error leaves Kept unchanged
      std::vector<ClutterMap::Key> keys;
      vtkAvianLidarWithin("Clutter filter: ",
        [&]()
        {
          std::copy(this->SensorPosition, this->SensorPosition + 3, memory.Position);
          vtkAvianLidarWithin(
            ScanPort, [&]() { vtkAvianLidarScanStream::ReadPosition(cloud, memory.Position); });
        });
      SharePosition(ranks, cloud->GetNumberOfPoints() > 0, memory.Position);
      vtkAvianLidarWithin("Clutter filter: ",
        [&]()
        {
          this->Advance(cloud, vtkPolyData::GetData(inputVector[1]), memory);
          keys = KeysOf(cloud, memory.Of);
        });
      vtkAvianLidarRanks::Settings settings;
      settings.Add("time", memory.Stream.Time());
      settings.Add("Window", this->Window);
      settings.Add("ClutterThreshold", this->ClutterThreshold);
      settings.Add("RangeStep", this->RangeStep);
      settings.Add("AzimuthStep", this->AzimuthStep);
      settings.Add("ElevationStep", this->ElevationStep);
      settings.Add("RangeTolerance", this->RangeTolerance);
      settings.Add("AngularTolerance", this->AngularTolerance);
      settings.Add("WarmUp", this->WarmUp);
      settings.Add("Learning", this->Learning);
      for (const double coordinate : memory.Of.Position)
      {
        settings.Add("position (or SensorPosition)", coordinate);
      }
      settings.Add("the checksum of input port 1 (table)", memory.Of.Table);
      settings.Add("learned_scans", memory.Before ? memory.Before->scans() : 0);
      ranks.AgreeOn(settings);
      const vtkSmartPointer<vtkPointSet> all = vtkAvianLidarGather::Coordinates(ranks, cloud);
      memory.With = !this->Learning ? memory.Before
                                    : std::make_shared<const ClutterMap>(memory.Before->learned(
                                        ranks.Alone() ? keys : KeysOf(all, memory.Of)));
      vtkPointSet* scan = vtkPointSet::GetData(outputVector, 0);
      vtkPolyData* table = vtkPolyData::GetData(outputVector, 1);
      scan->ShallowCopy(cloud);
      this->Classify(memory, keys, scan);
      if (ranks.Piece() <= 0)
      {
        WriteTable(*memory.With, memory.Of.Position, table);
      }
      else if (ranks.Alone())
      {
        scan->Initialize();
      }
      this->AddSettings(memory, scan->GetFieldData());
      this->AddSettings(memory, table->GetFieldData());
      ranks.Meet(); // before the memory changes
      *this->Kept = std::move(memory);
    });
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarClutterFilter, Window, ClutterThreshold, RangeStep,
  AzimuthStep, ElevationStep, RangeTolerance, AngularTolerance, WarmUp, SensorPosition, Learning,
  Controller, ErrorsAsData);
