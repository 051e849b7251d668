// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCloudComparison.h"

#include "ParallelLoop.h"
#include "ScanBeams.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGather.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"

#include "vtkDemandDrivenPipeline.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

constexpr int Ports = 2;
const char* const CloudNames[Ports] = { "simulated", "reference" };

std::string NameOf(int port)
{
  return "Cloud comparison: input port " + std::to_string(port) + " (" + CloudNames[port] +
    " cloud)";
}

void CheckCloud(vtkPointSet* cloud, int port)
{
  for (vtkIdType i = 0; i < cloud->GetNumberOfPoints(); ++i)
  {
    double p[3];
    cloud->GetPoint(i, p);
    // checkPosition() limits coordinates, so that their squares and cubes are finite.
    const std::string wrong = avianlidar::checkPosition({ p[0], p[1], p[2] });
    if (!wrong.empty())
    {
      vtkAvianLidarRequire(wrong, NameOf(port) + ": point " + std::to_string(i) + ": ");
    }
  }
}

// Distances from the points of one cloud to the nearest points of the other cloud, with the largest
// distance, the root mean square and the density-aware mean of all ranks.
struct Direction
{
  vtkSmartPointer<vtkDoubleArray> Distances;
  vtkNew<vtkIdTypeArray> Nearest; // numbers of the nearest places, the same on all ranks
  double Largest = 0.0;
  double RootMeanSquare = 0.0;
  double DensityAware = 0.0;
};

// Places of a cloud with their numbers. Some locators of VTK divide space into equal cells, which a
// single point far away makes useless. The other locators round coordinates to single precision.
using Place = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
using NumberedPlace = std::pair<Place, vtkIdType>;
using PlaceTree = boost::geometry::index::rtree<NumberedPlace, boost::geometry::index::linear<16>>;

Place PlaceOf(vtkPointSet* cloud, vtkIdType i)
{
  double p[3];
  cloud->GetPoint(i, p);
  return { p[0], p[1], p[2] };
}

// Points in one place have one number. Numbers follow the order of x, then y, then z.
PlaceTree TreeOf(vtkPointSet* cloud)
{
  std::vector<std::array<double, 3>> points(static_cast<std::size_t>(cloud->GetNumberOfPoints()));
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    cloud->GetPoint(static_cast<vtkIdType>(i), points[i].data());
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<NumberedPlace> places;
  places.reserve(points.size());
  for (const std::array<double, 3>& p : points)
  {
    places.emplace_back(Place(p[0], p[1], p[2]), static_cast<vtkIdType>(places.size()));
  }
  return PlaceTree(places.begin(), places.end());
}

// Square of the distance to the nearest place, and number of this place. If several places are
// equally near, the least number is returned. `found` is workspace.
std::pair<double, vtkIdType> NearestIn(
  const PlaceTree& tree, const Place& place, std::vector<NumberedPlace>& found)
{
  for (unsigned most = 2;; most *= 8)
  {
    found.clear();
    tree.query(boost::geometry::index::nearest(place, most), std::back_inserter(found));
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = 0.0;
    vtkIdType number = 0;
    for (const NumberedPlace& other : found)
    {
      const double square = boost::geometry::comparable_distance(place, other.first);
      number = square < nearest ? other.second
                                : (square > nearest ? number : std::min(number, other.second));
      nearest = std::min(nearest, square);
      farthest = std::max(farthest, square);
    }
    if (farthest > nearest || found.size() < most) // all equally near places are found
    {
      return { nearest, number };
    }
  }
}

// Measures distances. The progress of `filter` goes from `start` to `start` + 0.5.
void Measure(
  vtkPointSet* from, vtkPointSet* to, vtkAlgorithm* filter, double start, Direction& result)
{
  constexpr vtkIdType block = 16384;
  const vtkIdType size = from->GetNumberOfPoints();
  const PlaceTree tree = TreeOf(to);
  std::vector<NumberedPlace> found;
  result.Distances = Arrays::Make<vtkDoubleArray>(Arrays::NearestDistance, size);
  result.Nearest->SetNumberOfValues(size);
  for (vtkIdType i = 0; i < size; ++i)
  {
    if (i % block == 0)
    {
      filter->UpdateProgress(start + 0.5 * static_cast<double>(i) / static_cast<double>(size));
      vtkAvianLidarAbort::StopIfWanted(filter);
    }
    const auto [square, number] = NearestIn(tree, PlaceOf(from, i), found);
    result.Distances->SetValue(i, std::sqrt(square));
    result.Nearest->SetValue(i, number);
  }
}

// Computes the measures of all ranks from the distances of each rank. All ranks must call this
// function.
// @param others number of points of the other cloud on all ranks
void Summarise(
  const vtkAvianLidarRanks& ranks, vtkIdType others, double alpha, Direction& direction)
{
  vtkSmartPointer<vtkIdTypeArray> nearest = direction.Nearest;
  if (!ranks.Alone())
  {
    nearest = vtkSmartPointer<vtkIdTypeArray>::New();
    ranks.Gather(direction.Nearest, nearest);
  }
  std::vector<vtkIdType> counts(static_cast<std::size_t>(others));
  for (vtkIdType i = 0; i < nearest->GetNumberOfValues(); ++i)
  {
    ++counts[static_cast<std::size_t>(nearest->GetValue(i))];
  }
  const double* values = direction.Distances->GetPointer(0);
  const vtkIdType size = direction.Distances->GetNumberOfTuples();
  double sum = 0.0;
  double densityAware = 0.0;
  for (vtkIdType i = 0; i < size; ++i)
  {
    sum += values[i] * values[i];
    direction.Largest = std::max(direction.Largest, values[i]);
    const auto place = static_cast<std::size_t>(direction.Nearest->GetValue(i));
    densityAware += 1.0 - std::exp(-alpha * values[i]) / static_cast<double>(counts[place]);
  }
  direction.Largest = ranks.Largest(direction.Largest);
  sum = ranks.Sum(sum);
  const double number = ranks.Sum(static_cast<double>(size));
  direction.RootMeanSquare = std::sqrt(sum / number);
  direction.DensityAware = ranks.Sum(densityAware) / number;
}

// Removes the points of a piece, because piece 0 has the whole comparison.
void LeavePointsOut(vtkPointSet* cloud)
{
  vtkNew<vtkFieldData> fields;
  fields->ShallowCopy(cloud->GetFieldData());
  cloud->Initialize();
  cloud->SetFieldData(fields);
}
}

vtkStandardNewMacro(vtkAvianLidarCloudComparison);
vtkCxxSetSmartPointerMacro(vtkAvianLidarCloudComparison, Controller, vtkMultiProcessController);

//------------------------------------------------------------------------------
vtkMultiProcessController* vtkAvianLidarCloudComparison::GetController()
{
  return this->Controller;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCloudComparison::ModifyRequest(vtkInformation* request, int when)
{
  if (when == vtkExecutive::BeforeForward && request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()))
  {
    this->ForgetResult(); // VTK does not call RequestData() if a producer returned 0
  }
  return vtkAvianLidarRanks::UpdateInputs(this, request, when) &&
    this->Superclass::ModifyRequest(request, when);
}

//------------------------------------------------------------------------------
vtkAvianLidarCloudComparison::vtkAvianLidarCloudComparison()
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
  this->SetNumberOfInputPorts(Ports);
  this->SetNumberOfOutputPorts(Ports);
  this->ForgetResult();
}

//------------------------------------------------------------------------------
void vtkAvianLidarCloudComparison::ForgetResult()
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  this->HausdorffDistance = nan;
  this->HausdorffSimulatedToReference = nan;
  this->HausdorffReferenceToSimulated = nan;
  this->RMSESimulatedToReference = nan;
  this->RMSEReferenceToSimulated = nan;
  this->DensityAwareChamferDistance = nan;
  this->DensityAwareChamferSimulatedToReference = nan;
  this->DensityAwareChamferReferenceToSimulated = nan;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCloudComparison::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCloudComparison::RequestDataObject(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  for (int port = 0; port < Ports; ++port)
  {
    vtkPointSet* input = vtkPointSet::GetData(inputVector[port]);
    vtkPointSet* output = vtkPointSet::GetData(outputVector, port);
    if (!input)
    {
      return 0;
    }
    if (!output || !output->IsA(input->GetClassName()))
    {
      auto created = vtkSmartPointer<vtkPointSet>::Take(input->NewInstance());
      outputVector->GetInformationObject(port)->Set(vtkDataObject::DATA_OBJECT(), created);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCloudComparison::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  const vtkAvianLidarRanks ranks(this->Controller, request, outputVector);
  for (int port = 0; port < Ports; ++port)
  {
    ranks.RequestPiece(inputVector[port]);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCloudComparison::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks)
    {
      vtkPointSet* clouds[Ports];
      vtkSmartPointer<vtkPointSet> whole[Ports];
      Direction directions[Ports];
      vtkAvianLidarRequire(
        avianlidar::rangeError("ChamferAlpha", this->ChamferAlpha, 1e-6, 1e6, "1e-6 to 1e6 1/m"));
      for (int port = 0; port < Ports; ++port)
      {
        clouds[port] = vtkPointSet::GetData(inputVector[port]);
        CheckCloud(clouds[port], port);
      }
      vtkAvianLidarRanks::Settings settings;
      settings.Add("ChamferAlpha", this->ChamferAlpha);
      ranks.AgreeOn(settings);
      for (int port = 0; port < Ports; ++port)
      {
        whole[port] = vtkAvianLidarGather::Coordinates(ranks, clouds[port]);
        vtkAvianLidarRequire(whole[port]->GetNumberOfPoints() > 0
            ? ""
            : NameOf(port) + " has no points, expected at least one point");
      }
      Measure(clouds[0], whole[1], this, 0.0, directions[0]);
      Measure(clouds[1], whole[0], this, 0.5, directions[1]);
      for (int port = 0; port < Ports; ++port)
      {
        const vtkIdType others = whole[1 - port]->GetNumberOfPoints();
        Summarise(ranks, others, this->ChamferAlpha, directions[port]);
      }
      this->HausdorffSimulatedToReference = directions[0].Largest;
      this->HausdorffReferenceToSimulated = directions[1].Largest;
      this->HausdorffDistance = std::max(directions[0].Largest, directions[1].Largest);
      this->RMSESimulatedToReference = directions[0].RootMeanSquare;
      this->RMSEReferenceToSimulated = directions[1].RootMeanSquare;
      this->DensityAwareChamferSimulatedToReference = directions[0].DensityAware;
      this->DensityAwareChamferReferenceToSimulated = directions[1].DensityAware;
      this->DensityAwareChamferDistance =
        0.5 * (directions[0].DensityAware + directions[1].DensityAware);

      try
      {
        for (int port = 0; port < Ports; ++port)
        {
          vtkPointSet* output = vtkPointSet::GetData(outputVector, port);
          output->ShallowCopy(clouds[port]);
          output->GetPointData()->AddArray(directions[port].Distances);
          this->AddResult(output->GetFieldData());
          if (ranks.Alone() && ranks.Piece() > 0)
          {
            LeavePointsOut(output);
          }
        }
        ranks.Meet();
      }
      catch (...)
      {
        this->ForgetResult();
        throw;
      }
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarCloudComparison::AddResult(vtkFieldData* fields) const
{
  Arrays::SetFieldValue(fields, Arrays::HausdorffDistance, this->HausdorffDistance);
  Arrays::SetFieldValue(
    fields, Arrays::HausdorffSimulatedToReference, this->HausdorffSimulatedToReference);
  Arrays::SetFieldValue(
    fields, Arrays::HausdorffReferenceToSimulated, this->HausdorffReferenceToSimulated);
  Arrays::SetFieldValue(fields, Arrays::RMSESimulatedToReference, this->RMSESimulatedToReference);
  Arrays::SetFieldValue(fields, Arrays::RMSEReferenceToSimulated, this->RMSEReferenceToSimulated);
  Arrays::SetFieldValue(fields, Arrays::ChamferDistance, this->DensityAwareChamferDistance);
  Arrays::SetFieldValue(
    fields, Arrays::ChamferSimulatedToReference, this->DensityAwareChamferSimulatedToReference);
  Arrays::SetFieldValue(
    fields, Arrays::ChamferReferenceToSimulated, this->DensityAwareChamferReferenceToSimulated);
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarCloudComparison, Controller, ErrorsAsData,
  HausdorffDistance, HausdorffSimulatedToReference, HausdorffReferenceToSimulated,
  RMSESimulatedToReference, RMSEReferenceToSimulated, DensityAwareChamferDistance,
  DensityAwareChamferSimulatedToReference, DensityAwareChamferReferenceToSimulated, ChamferAlpha);
