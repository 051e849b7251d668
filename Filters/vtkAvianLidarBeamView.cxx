// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarBeamView.h"

#include "BeamShape.h"
#include "BeamSurfaces.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanFilterInternals.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkAvianLidarBeamView);

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using avianlidar::SeenSurface;
using avianlidar::Vec3;

constexpr char NoSurface[] = "no surface";

double EnergyOf(const std::vector<SeenSurface>& seen)
{
  double sum = 0.0;
  for (const SeenSurface& one : seen)
  {
    sum += one.energy;
  }
  return sum;
}

/// Array with one value of each surface, for rows or cells.
template <class ArrayT, class F>
vtkSmartPointer<ArrayT> ArrayOf(
  const Arrays::Name& name, const std::vector<SeenSurface>& seen, F valueOf)
{
  auto array = Arrays::Make<ArrayT>(name, static_cast<vtkIdType>(seen.size()));
  for (std::size_t i = 0; i < seen.size(); ++i)
  {
    array->SetValue(static_cast<vtkIdType>(i), valueOf(seen[i]));
  }
  return array;
}

/// Arrays that cells and rows have in common.
std::vector<vtkSmartPointer<vtkDataArray>> NumbersOf(
  const std::vector<SeenSurface>& seen, double energy)
{
  return { ArrayOf<vtkIntArray>(
             Arrays::ObjectId, seen, [](const SeenSurface& one) { return one.objectId; }),
    ArrayOf<vtkIntArray>(
      Arrays::MaterialId, seen, [](const SeenSurface& one) { return one.materialId; }),
    ArrayOf<vtkDoubleArray>(
      Arrays::SolidAngleShare, seen, [](const SeenSurface& one) { return one.share; }),
    ArrayOf<vtkDoubleArray>(Arrays::EnergyShare, seen,
      [energy](const SeenSurface& one) { return energy > 0.0 ? one.energy / energy : 0.0; }),
    ArrayOf<vtkDoubleArray>(
      Arrays::EnergyReceived, seen, [](const SeenSurface& one) { return one.energy; }),
    ArrayOf<vtkDoubleArray>(
      Arrays::Distance, seen, [](const SeenSurface& one) { return one.range; }) };
}

void FillSurfaces(
  const avianlidar::BeamFrame& frame, const std::vector<SeenSurface>& seen, vtkPolyData* surfaces)
{
  const std::vector<Vec3> outline = avianlidar::outlineOf(frame);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  std::vector<SeenSurface> shown; // surfaces with a part within the outline
  for (const SeenSurface& one : seen)
  {
    std::vector<vtkIdType> polygon;
    for (const Vec3& at : avianlidar::partWithin(frame, outline, one))
    {
      const Vec3 place = frame.origin + at;
      polygon.push_back(points->InsertNextPoint(&place.x));
    }
    if (!polygon.empty())
    {
      cells->InsertNextCell(static_cast<vtkIdType>(polygon.size()), polygon.data());
      shown.push_back(one);
    }
  }
  surfaces->SetPoints(points);
  surfaces->SetPolys(cells);
  for (const auto& array : NumbersOf(shown, EnergyOf(seen)))
  {
    surfaces->GetCellData()->AddArray(array);
  }
  surfaces->GetCellData()->AddArray(ArrayOf<vtkDoubleArray>(Arrays::IncidenceAngle, shown,
    [](const SeenSurface& one)
    { return vtkMath::DegreesFromRadians(std::acos(std::min(1.0, one.cosine))); }));
  surfaces->GetCellData()->SetActiveScalars(Arrays::EnergyShare.name);
}

void FillCone(const avianlidar::BeamFrame& frame, double length, vtkPolyData* cone)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->InsertNextPoint(&frame.origin.x);
  vtkNew<vtkCellArray> cells;
  const std::vector<Vec3> outline = avianlidar::outlineOf(frame);
  const auto sides = static_cast<vtkIdType>(outline.size());
  for (vtkIdType i = 0; i < sides; ++i)
  {
    const Vec3 end =
      frame.origin + length * avianlidar::unitVector(outline[static_cast<std::size_t>(i)]);
    points->InsertNextPoint(&end.x);
    const vtkIdType side[] = { 0, 1 + i, 1 + (i + 1) % sides };
    cells->InsertNextCell(3, side);
  }
  cone->SetPoints(points);
  cone->SetPolys(cells);
}

/// Sums over the surfaces of each object and material, most energy first, then the sky.
std::vector<SeenSurface> RowsOf(const std::vector<SeenSurface>& seen)
{
  std::map<std::pair<int, int>, SeenSurface> sums;
  SeenSurface sky;
  sky.objectId = sky.materialId = -1;
  sky.range = sky.nearest = sky.farthest = std::numeric_limits<double>::quiet_NaN();
  double share = 0.0;
  for (const SeenSurface& one : seen)
  {
    share += one.share;
    const auto [place, isNew] = sums.try_emplace({ one.objectId, one.materialId }, one);
    if (isNew)
    {
      continue;
    }
    SeenSurface& sum = place->second;
    const double weight = sum.weight + one.weight;
    if (one.weight > 0.0) // without weight, the range is unknown
    {
      sum.range =
        sum.weight > 0.0 ? (sum.weight * sum.range + one.weight * one.range) / weight : one.range;
    }
    sum.weight = weight;
    sum.share += one.share;
    sum.energy += one.energy;
    sum.nearest = std::fmin(sum.nearest, one.nearest);
    sum.farthest = std::fmax(sum.farthest, one.farthest);
  }
  std::vector<SeenSurface> rows;
  for (const auto& [ids, sum] : sums)
  {
    rows.push_back(sum);
  }
  std::stable_sort(rows.begin(), rows.end(),
    [](const SeenSurface& a, const SeenSurface& b) { return a.energy > b.energy; });
  sky.share = std::max(0.0, 1.0 - share);
  rows.push_back(sky);
  return rows;
}

void FillTable(const std::vector<SeenSurface>& rows, vtkFieldData* fields, vtkTable* table)
{
  auto objects = Arrays::Make<vtkStringArray>(Arrays::Object);
  auto materials = Arrays::Make<vtkStringArray>(Arrays::Material);
  for (const SeenSurface& row : rows)
  {
    objects->InsertNextValue(
      &row == &rows.back() ? NoSurface : Arrays::TextAt(fields, Arrays::ObjectNames, row.objectId));
    materials->InsertNextValue(Arrays::TextAt(fields, Arrays::MaterialNames, row.materialId));
  }
  table->AddColumn(objects);
  table->AddColumn(materials);
  for (const auto& array : NumbersOf(rows, EnergyOf(rows)))
  {
    table->AddColumn(array);
  }
  table->AddColumn(ArrayOf<vtkDoubleArray>(
    Arrays::NearestRange, rows, [](const SeenSurface& row) { return row.nearest; }));
  table->AddColumn(ArrayOf<vtkDoubleArray>(
    Arrays::FarthestRange, rows, [](const SeenSurface& row) { return row.farthest; }));
}
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamView::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 2 ? "vtkTable" : "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarBeamView::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInternals& in = *this->Internals;
  in.TracedRays = in.TracedBeams = 0.0;
  in.Setup.settings.noise = false;
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks)
    {
      vtkPolyData* beams = vtkPolyData::GetData(inputVector[0]);
      vtkPolyData* seen = vtkPolyData::GetData(outputVector, 0);
      vtkPolyData* cone = vtkPolyData::GetData(outputVector, 1);
      vtkTable* shares = vtkTable::GetData(outputVector, 2);
      vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      vtkAvianLidarRanks::Settings own;
      own.Add("BeamId", this->BeamId);
      ranks.AgreeOn(own);
      this->Prepare(ranks, inputVector);
      this->Look(ranks, beams->GetFieldData(), seen, cone, shares);
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarBeamView::Look(const vtkAvianLidarRanks& ranks, vtkFieldData* beamFields,
  vtkPolyData* surfaces, vtkPolyData* cone, vtkTable* shares)
{
  vtkInternals& in = *this->Internals;
  const std::vector<std::uint64_t>& ids = in.Beams.beams.ids;
  const auto place = std::find(ids.begin(), ids.end(), static_cast<std::uint64_t>(this->BeamId));
  const bool isHere = place != ids.end() && this->BeamId >= 0;
  const bool isAnywhere = ranks.Sum(isHere ? 1.0 : 0.0) > 0.0;
  if (!isAnywhere && in.Beams.total > 0)
  {
    vtkAvianLidarRequire("BeamId is " + std::to_string(this->BeamId) +
      ", expected the beam_id of a beam of input port 0 (beams)");
  }
  avianlidar::planModel(in.Setup);
  for (vtkDataObject* output : std::initializer_list<vtkDataObject*>{ surfaces, cone, shares })
  {
    this->FillFields(beamFields, output->GetFieldData());
    output->GetFieldData()->AddArray(
      Arrays::MakeOf<vtkIdTypeArray>(Arrays::BeamId, std::vector<vtkIdType>{ this->BeamId }));
  }
  if (!isHere)
  {
    return;
  }
  in.Setup.settings.fullModel = true; // for faint samples, too
  avianlidar::planModel(in.Setup);
  const auto beam = static_cast<std::size_t>(place - ids.begin());
  const avianlidar::KeepGoing keepGoing =
    vtkAvianLidarAbort::KeepGoing(this, vtkInternals::BuildShare, 1.0);
  const std::vector<SeenSurface> seen =
    avianlidar::surfacesAlong(in.Setup, in.Beams.beams, beam, [&] { return keepGoing(0.0); });
  const avianlidar::BeamFrame frame = avianlidar::makeBeamFrame(in.Beams.beams.origins[beam],
    in.Beams.beams.directions[beam], avianlidar::BeamShape(in.Setup.sensor).width());
  double length = 0.0;
  for (const SeenSurface& one : seen)
  {
    length = std::max(length, one.farthest);
  }
  FillSurfaces(frame, seen, surfaces);
  FillCone(frame, length > 0.0 ? length : in.Beams.displayLength, cone);
  FillTable(RowsOf(seen), shares->GetFieldData(), shares);
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarBeamView, BeamId);
