// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarLandmarks.h"

#include "ScanPattern.h"
#include "ValueError.h"
#include "Vector.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"

#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkAvianLidarLandmarks);

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Vec3;

constexpr double Slender = 0.1; ///< greatest width of a runway, as a share of its length
constexpr double Wide = 0.25;   ///< greatest width of a building, as a share of the scene's
constexpr double Low = 2.0;     ///< least height of a building, m
constexpr int Corners = 180;    ///< corners of each ring
constexpr int Ways = 12;        ///< directions around the lidar in which beams are drawn
constexpr int MostLasers = 16;  ///< drawn beams in a direction
constexpr Arrays::Name Text{ "name", "" };

/// Words that say no more of a thing than its class.
const std::set<std::string> Kinds{ "apron", "building", "grass", "ground", "hangar", "house",
  "parking", "road", "structure", "taxiway", "terrain", "tree", "water" };

/// The direction as one of eight winds.
std::string Wind(double east, double north)
{
  static const std::array<std::string, 8> winds{ "north", "north-east", "east", "south-east",
    "south", "south-west", "west", "north-west" };
  const double turn = std::atan2(east, north) / (vtkMath::Pi() / 4.0);
  return winds[static_cast<std::size_t>(std::lround(turn) + 8) % 8];
}

/// Designators in a name, such as "09" and "27L": one or two digits, and a letter.
std::vector<std::string> Designators(const std::string& name)
{
  static const std::regex pattern("(?:^|[^0-9])([0-9]{1,2}[A-Z]?)(?![0-9A-Za-z])");
  std::vector<std::string> found;
  for (std::sregex_iterator one(name.begin(), name.end(), pattern), end; one != end; ++one)
  {
    found.push_back((*one)[1]);
  }
  return found;
}

/// Points with texts, or lines.
class Drawing
{
public:
  void Add(const Vec3& place, const std::string& text)
  {
    this->Texts->InsertNextValue(text);
    this->AddLine({ place }, false);
  }
  void AddLine(const std::vector<Vec3>& places, bool isClosed)
  {
    const vtkIdType first = this->Points->GetNumberOfPoints();
    const auto size = static_cast<vtkIdType>(places.size());
    this->Cells->InsertNextCell(size + (isClosed ? 1 : 0));
    for (const Vec3& place : places)
    {
      this->Cells->InsertCellPoint(this->Points->InsertNextPoint(&place.x));
    }
    if (isClosed)
    {
      this->Cells->InsertCellPoint(first);
    }
  }
  void Fill(vtkPolyData* output)
  {
    const bool hasTexts = this->Texts->GetNumberOfValues() > 0;
    output->SetPoints(this->Points);
    hasTexts ? output->SetVerts(this->Cells) : output->SetLines(this->Cells);
    if (hasTexts)
    {
      output->GetPointData()->AddArray(this->Texts);
    }
  }

private:
  vtkSmartPointer<vtkPoints> Points = Arrays::MakePoints(0);
  vtkNew<vtkCellArray> Cells;
  vtkSmartPointer<vtkStringArray> Texts = Arrays::Make<vtkStringArray>(Text);
};

/// Named objects of the surfaces.
class Objects
{
public:
  explicit Objects(vtkPolyData* surfaces)
    : Surfaces(surfaces)
    , Names(Arrays::FindTexts(surfaces->GetFieldData(), Arrays::ObjectNames))
  {
    vtkDataArray* ids = surfaces->GetCellData()->GetArray(Arrays::ObjectId.name);
    if (!this->Names || !ids)
    {
      return;
    }
    const vtkIdType before = surfaces->GetNumberOfVerts() + surfaces->GetNumberOfLines();
    auto cell = vtk::TakeSmartPointer(surfaces->GetPolys()->NewIterator());
    for (cell->GoToFirstCell(); !cell->IsDoneWithTraversal(); cell->GoToNextCell())
    {
      const double id = ids->GetComponent(before + cell->GetCurrentCellId(), 0);
      if (id >= 0.0 && id < static_cast<double>(this->Names->GetNumberOfValues()))
      {
        vtkIdType size = 0;
        const vtkIdType* corners = nullptr;
        cell->GetCurrentCell(size, corners);
        this->CornersOf[static_cast<vtkIdType>(id)].insert(corners, corners + size);
        Vec3 middle(0.0);
        for (vtkIdType i = 0; i < size; ++i)
        {
          const double* p = surfaces->GetPoint(corners[i]);
          middle += Vec3(p[0], p[1], p[2]) / static_cast<double>(size);
        }
        this->MiddlesOf[static_cast<vtkIdType>(id)].push_back(middle);
      }
    }
  }

  void AddNames(int mostBuildings, Drawing& names) const
  {
    std::multimap<double, std::pair<std::string, Vec3>> buildings; // by minus area
    double length[3];
    vtkBoundingBox(this->Surfaces->GetBounds()).GetLengths(length);
    for (const auto& [id, corners] : this->CornersOf)
    {
      const std::string name = this->Names->GetValue(id);
      if (Arrays::TextAt(this->Surfaces->GetFieldData(), Arrays::ObjectClasses, id) == "runway")
      {
        this->AddEnds(name, corners, names);
        continue;
      }
      vtkBoundingBox box;
      for (const vtkIdType corner : corners)
      {
        box.AddPoint(this->Surfaces->GetPoint(corner));
      }
      const double width = box.GetLength(0);
      const double depth = box.GetLength(1);
      if (vtkAvianLidarLandmarks::IsOwnName(name) && box.GetLength(2) >= Low &&
        width <= Wide * length[0] && depth <= Wide * length[1])
      {
        Vec3 centre;
        box.GetCenter(&centre.x);
        // On the building, also if its plan is not convex.
        const auto off = [&centre](const Vec3& p)
        { return std::hypot(p.x - centre.x, p.y - centre.y); };
        const std::vector<Vec3>& middles = this->MiddlesOf.at(id);
        Vec3 top = *std::min_element(middles.begin(), middles.end(),
          [&off](const Vec3& a, const Vec3& b) { return off(a) < off(b); });
        top.z = box.GetMaxPoint()[2];
        buildings.emplace(-width * depth, std::make_pair(name, top));
      }
    }
    for (const auto& [area, building] : buildings)
    {
      if (mostBuildings-- <= 0)
      {
        return;
      }
      names.Add(building.second, building.first);
    }
  }

private:
  /// Names of the ends of a slender runway, in the direction of its largest extent.
  void AddEnds(std::string name, const std::set<vtkIdType>& corners, Drawing& names) const
  {
    Vec3 middle(0.0, 0.0, -VTK_DOUBLE_MAX);
    for (const vtkIdType corner : corners)
    {
      const double* p = this->Surfaces->GetPoint(corner);
      middle += Vec3(p[0], p[1], 0.0) / static_cast<double>(corners.size());
      middle.z = std::max(middle.z, p[2]);
    }
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const vtkIdType corner : corners)
    {
      const double* p = this->Surfaces->GetPoint(corner);
      xx += (p[0] - middle.x) * (p[0] - middle.x);
      xy += (p[0] - middle.x) * (p[1] - middle.y);
      yy += (p[1] - middle.y) * (p[1] - middle.y);
    }
    if (!std::isfinite(xx + yy))
    {
      return;
    }
    const double turn = 0.5 * std::atan2(2.0 * xy, xx - yy);
    const Vec3 axis(std::cos(turn), std::sin(turn), 0.0);
    vtkBoundingBox box; // along, across
    for (const vtkIdType corner : corners)
    {
      const double* p = this->Surfaces->GetPoint(corner);
      const Vec3 off(p[0] - middle.x, p[1] - middle.y, 0.0);
      box.AddPoint(dot(off, axis), off.y * axis.x - off.x * axis.y, 0.0);
    }
    if (box.GetLength(1) >= Slender * box.GetLength(0))
    {
      return; // several runways in one object
    }
    if (name.size() > 7 && (name.rfind("Runway ", 0) == 0 || name.rfind("runway ", 0) == 0))
    {
      name.erase(0, 7);
    }
    names.Add(middle + box.GetMinPoint()[0] * axis,
      vtkAvianLidarLandmarks::EndName(name, -axis.x, -axis.y));
    names.Add(
      middle + box.GetMaxPoint()[0] * axis, vtkAvianLidarLandmarks::EndName(name, axis.x, axis.y));
  }

  vtkPolyData* Surfaces;
  vtkStringArray* Names;
  std::map<vtkIdType, std::set<vtkIdType>> CornersOf;
  std::map<vtkIdType, std::vector<Vec3>> MiddlesOf; ///< middles of its polygons
};

/// For each drawn laser and direction, the beam that is nearest to the direction.
std::vector<vtkIdType> BeamsOfFan(vtkDataArray* directions, vtkDataArray* lasers)
{
  std::map<double, std::size_t> places; // of the lasers in the order of their numbers
  for (vtkIdType i = 0; i < lasers->GetNumberOfTuples(); ++i)
  {
    if (const double laser = lasers->GetComponent(i, 0); std::isfinite(laser))
    {
      places[laser] = 0;
    }
  }
  std::size_t number = 0;
  for (auto& [laser, place] : places)
  {
    place = number++;
  }
  const std::size_t step = std::max<std::size_t>(1, number / MostLasers);
  std::map<std::pair<double, int>, std::pair<double, vtkIdType>> nearest;
  for (vtkIdType i = 0; i < lasers->GetNumberOfTuples(); ++i)
  {
    const double laser = lasers->GetComponent(i, 0);
    const auto known = places.find(laser);
    if (known != places.end() && known->second % step == 0 &&
      std::isfinite(directions->GetComponent(i, 0) + directions->GetComponent(i, 1)))
    {
      const double turn =
        std::atan2(directions->GetComponent(i, 0), directions->GetComponent(i, 1)) * Ways /
        (2.0 * vtkMath::Pi());
      const auto way = static_cast<int>(std::lround(turn) + Ways) % Ways;
      const std::pair<double, vtkIdType> off(std::abs(turn - std::round(turn)), i);
      auto& best = nearest.emplace(std::make_pair(laser, way), off).first->second;
      best = std::min(best, off);
    }
  }
  std::vector<vtkIdType> beams;
  for (const auto& [where, off] : nearest)
  {
    beams.push_back(off.second);
  }
  return beams;
}

void AddFan(vtkPolyData* beams, double length, Drawing& fan)
{
  vtkDataArray* directions = beams->GetPointData()->GetArray(Arrays::Direction.name);
  vtkDataArray* lasers = beams->GetPointData()->GetArray(Arrays::LaserId.name);
  if (!directions || directions->GetNumberOfComponents() != 3 || !lasers)
  {
    return;
  }
  for (const vtkIdType beam : BeamsOfFan(directions, lasers))
  {
    Vec3 way, start;
    directions->GetTuple(beam, &way.x);
    beams->GetPoint(beam, &start.x);
    fan.AddLine({ start, start + length * way }, false);
  }
}

void AddRings(
  const Vec3& middle, double spacing, int number, double direction, Drawing& rings, Drawing& ranges)
{
  const auto at = [&middle](double degrees, double range)
  {
    const auto [sine, cosine] = avianlidar::sinCosDegrees(degrees);
    return middle + range * Vec3(sine, cosine, 0.0);
  };
  for (int ring = 1; ring <= number; ++ring)
  {
    const double range = ring * spacing;
    std::vector<Vec3> corners;
    for (int corner = 0; corner < Corners; ++corner)
    {
      corners.push_back(at(corner * 360.0 / Corners, range));
    }
    rings.AddLine(corners, true);
    std::ostringstream text;
    text << range << " m";
    ranges.Add(at(direction, range), text.str());
  }
  if (number > 0)
  {
    ranges.Add(at(0.0, std::max(1, number / 2) * spacing), "N");
  }
}
}

//------------------------------------------------------------------------------
vtkAvianLidarLandmarks::vtkAvianLidarLandmarks()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(4);
}

//------------------------------------------------------------------------------
int vtkAvianLidarLandmarks::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Set(INPUT_IS_OPTIONAL(), 1);
  return 1;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarLandmarks::IsOwnName(const std::string& name)
{
  std::string word = name;
  for (char& letter : word)
  {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  word.erase(word.find_last_not_of(" 0123456789") + 1);
  const bool isPlural = !word.empty() && word.back() == 's';
  return !word.empty() && !Kinds.count(word) &&
    !(isPlural && Kinds.count(word.substr(0, word.size() - 1)));
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarLandmarks::EndName(const std::string& runway, double east, double north)
{
  const std::vector<std::string> found = Designators(runway);
  if (found.size() == 2)
  {
    const int tens[] = { std::stoi(found[0]), std::stoi(found[1]) };
    if (std::abs(tens[0] - tens[1]) == 18)
    {
      const double landing = vtkMath::DegreesFromRadians(std::atan2(-east, -north));
      const double off = std::remainder(10.0 * tens[0] - landing, 360.0);
      return found[off >= -90.0 && off < 90.0 ? 0 : 1]; // one for each end, whatever the direction
    }
  }
  return runway + " " + Wind(east, north);
}

//------------------------------------------------------------------------------
int vtkAvianLidarLandmarks::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      using namespace avianlidar;
      vtkAvianLidarRequire(
        rangeError("RingSpacing", this->RingSpacing, 1e-6, 1e9, "1e-6 to 1e9 m"));
      vtkAvianLidarRequire(rangeError("NumberOfRings", this->NumberOfRings, 0, 1000, "0 to 1000"));
      vtkAvianLidarRequire(rangeError(
        "RangeDirection", this->RangeDirection, -LargestFinite, LargestFinite, "a finite number"));
      vtkAvianLidarRequire(rangeError(
        "MaximumNumberOfBuildings", this->MaximumNumberOfBuildings, 0, VTK_INT_MAX, "at least 0"));
      vtkPolyData* beams = vtkPolyData::GetData(inputVector[0]);
      vtkPolyData* surfaces = vtkPolyData::GetData(inputVector[1]);
      Drawing names, rings, ranges, fan;
      if (surfaces)
      {
        Objects(surfaces).AddNames(this->MaximumNumberOfBuildings, names);
      }
      if (beams && beams->GetNumberOfPoints() > 0)
      {
        Vec3 middle;
        beams->GetPoint(0, &middle.x);
        const std::string misplaced = checkPosition(middle);
        vtkAvianLidarRequire(misplaced, "Input port 0, first beam: ");
        AddRings(
          middle, this->RingSpacing, this->NumberOfRings, this->RangeDirection, rings, ranges);
        AddFan(beams, this->RingSpacing, fan);
      }
      Drawing* drawings[] = { &rings, &ranges, &names, &fan };
      for (int port = 0; port < 4; ++port)
      {
        drawings[port]->Fill(vtkPolyData::GetData(outputVector, port));
      }
      auto distances = Arrays::Make<vtkDoubleArray>(Arrays::Distance, this->NumberOfRings);
      vtkPolyData* drawn = vtkPolyData::GetData(outputVector, 0);
      if (drawn->GetNumberOfLines() > 0)
      {
        for (int ring = 0; ring < this->NumberOfRings; ++ring)
        {
          distances->SetValue(ring, (ring + 1) * this->RingSpacing);
        }
        drawn->GetCellData()->AddArray(distances);
      }
    });
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarLandmarks, RingSpacing, NumberOfRings, RangeDirection,
  MaximumNumberOfBuildings, ErrorsAsData);
