// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCloudComparison.h"

#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGuard.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkStaticPointLocator.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

constexpr int Ports = 2;
const char* const CloudNames[Ports] = { "simulated", "reference" };

// What is wrong with a cloud, or an empty string.
std::string CheckCloud(vtkPointSet* cloud, int port)
{
  const std::string which =
    "input port " + std::to_string(port) + " (" + CloudNames[port] + " cloud)";
  if (!cloud || cloud->GetNumberOfPoints() == 0)
  {
    return which + " has no points: the distance to nothing is not defined";
  }
  for (vtkIdType i = 0; i < cloud->GetNumberOfPoints(); ++i)
  {
    double p[3];
    cloud->GetPoint(i, p);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
    {
      return which + ": point " + std::to_string(i) +
        " has a coordinate that is not finite, expected metres";
    }
  }
  return std::string();
}

// Distances of the points of one cloud to the nearest of another, and their largest and root mean
// square.
struct Direction
{
  vtkSmartPointer<vtkDoubleArray> Distances;
  double Largest = 0.0;
  double RootMeanSquare = 0.0;
  bool Aborted = false;
};

// Moves the progress of `filter` from `start` to `start` + 0.5.
Direction Measure(vtkPointSet* from, vtkPointSet* to, vtkAlgorithm* filter, double start)
{
  constexpr vtkIdType block = 16384;
  const vtkIdType size = from->GetNumberOfPoints();
  vtkNew<vtkStaticPointLocator> locator;
  locator->SetDataSet(to);
  locator->BuildLocator();
  Direction result;
  result.Distances = Arrays::Make<vtkDoubleArray>(Arrays::NearestDistance, size);
  double sum = 0.0;
  for (vtkIdType i = 0; i < size; ++i)
  {
    if (i % block == 0)
    {
      filter->UpdateProgress(start + 0.5 * static_cast<double>(i) / static_cast<double>(size));
      if (vtkAvianLidarAbort::Wanted(filter))
      {
        result.Aborted = true;
        return result;
      }
    }
    double p[3], q[3];
    from->GetPoint(i, p);
    to->GetPoint(locator->FindClosestPoint(p), q);
    const double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    const double squared = x * x + y * y + z * z;
    sum += squared;
    result.Distances->SetValue(i, std::sqrt(squared));
    result.Largest = std::max(result.Largest, result.Distances->GetValue(i));
  }
  result.RootMeanSquare = std::sqrt(sum / static_cast<double>(size));
  return result;
}
}

vtkStandardNewMacro(vtkAvianLidarCloudComparison);

//------------------------------------------------------------------------------
vtkAvianLidarCloudComparison::vtkAvianLidarCloudComparison()
{
  this->SetNumberOfInputPorts(Ports);
  this->SetNumberOfOutputPorts(Ports);
  this->ForgetResult();
}

//------------------------------------------------------------------------------
vtkAvianLidarCloudComparison::~vtkAvianLidarCloudComparison() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarCloudComparison::ForgetResult()
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  this->HausdorffDistance = nan;
  this->HausdorffSimulatedToReference = nan;
  this->HausdorffReferenceToSimulated = nan;
  this->RMSESimulatedToReference = nan;
  this->RMSEReferenceToSimulated = nan;
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
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  for (int port = 0; port < Ports; ++port)
  {
    vtkInformation* info = inputVector[port]->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCloudComparison::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> int
    {
      this->ForgetResult();
      vtkPointSet* clouds[Ports];
      for (int port = 0; port < Ports; ++port)
      {
        clouds[port] = vtkPointSet::GetData(inputVector[port]);
        const std::string problem = CheckCloud(clouds[port], port);
        if (!problem.empty())
        {
          vtkErrorMacro("Cloud comparison: " << problem << ".");
          return 0;
        }
      }
      const Direction forth = Measure(clouds[0], clouds[1], this, 0.0);
      const Direction back = forth.Aborted ? forth : Measure(clouds[1], clouds[0], this, 0.5);
      if (back.Aborted)
      {
        return 1;
      }
      this->HausdorffSimulatedToReference = forth.Largest;
      this->HausdorffReferenceToSimulated = back.Largest;
      this->HausdorffDistance = std::max(forth.Largest, back.Largest);
      this->RMSESimulatedToReference = forth.RootMeanSquare;
      this->RMSEReferenceToSimulated = back.RootMeanSquare;

      for (int port = 0; port < Ports; ++port)
      {
        vtkPointSet* output = vtkPointSet::GetData(outputVector, port);
        output->ShallowCopy(clouds[port]);
        output->GetPointData()->AddArray(port == 0 ? forth.Distances : back.Distances);
        vtkFieldData* fields = output->GetFieldData();
        Arrays::SetFieldValue(fields, Arrays::HausdorffDistance, this->HausdorffDistance);
        Arrays::SetFieldValue(
          fields, Arrays::HausdorffSimulatedToReference, this->HausdorffSimulatedToReference);
        Arrays::SetFieldValue(
          fields, Arrays::HausdorffReferenceToSimulated, this->HausdorffReferenceToSimulated);
        Arrays::SetFieldValue(
          fields, Arrays::RMSESimulatedToReference, this->RMSESimulatedToReference);
        Arrays::SetFieldValue(
          fields, Arrays::RMSEReferenceToSimulated, this->RMSEReferenceToSimulated);
      }
      return 1;
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarCloudComparison::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "HausdorffDistance: " << this->HausdorffDistance << "\n";
  os << indent << "HausdorffSimulatedToReference: " << this->HausdorffSimulatedToReference << "\n";
  os << indent << "HausdorffReferenceToSimulated: " << this->HausdorffReferenceToSimulated << "\n";
  os << indent << "RMSESimulatedToReference: " << this->RMSESimulatedToReference << "\n";
  os << indent << "RMSEReferenceToSimulated: " << this->RMSEReferenceToSimulated << "\n";
}
