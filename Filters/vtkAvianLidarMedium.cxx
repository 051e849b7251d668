// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarMedium.h"

#include "JsonNode.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarMedia.h"
#include "vtkAvianLidarNames.h"

#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <stdexcept>

vtkStandardNewMacro(vtkAvianLidarMedium);

namespace
{
constexpr const char* KindNames[] = { "haze", "fog", "drizzle", "rain", "snow", "foliage",
  "custom" };
constexpr const char* ShapeNames[] = { "everywhere", "layer", "box", "ellipsoid", "surface" };

template <std::size_t N>
std::string NameOf(const char* property, int value, const char* const (&names)[N])
{
  if (value < 0 || value >= static_cast<int>(N))
  {
    const std::string expected = "0 to " + std::to_string(N - 1);
    throw std::runtime_error(avianlidar::valueError(property, value, expected.c_str()));
  }
  return names[value];
}

avianlidar::Json Triple(const double (&v)[3])
{
  return { v[0], v[1], v[2] };
}
}

//------------------------------------------------------------------------------
vtkAvianLidarMedium::vtkAvianLidarMedium() = default;

//------------------------------------------------------------------------------
vtkAvianLidarMedium::~vtkAvianLidarMedium() = default;

//------------------------------------------------------------------------------
int vtkAvianLidarMedium::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
/// What the properties say, of which only those of the kind and the shape.
std::string vtkAvianLidarMedium::Description() const
{
  avianlidar::Json json;
  json["kind"] = NameOf("Kind", this->Kind, KindNames);
  json["name"] = this->Name;
  switch (this->Kind)
  {
    case KIND_DRIZZLE:
    case KIND_RAIN:
      json["rain_rate"] = this->RainRate;
      break;
    case KIND_FOLIAGE:
      json["leaf_area_density"] = this->LeafAreaDensity;
      break;
    case KIND_CUSTOM:
      json["extinction"] = this->Extinction;
      json["backscatter_ratio"] = this->BackscatterRatio;
      break;
    default:
      json["visibility"] = this->Visibility;
  }
  if (this->RenewedShare != -1.0 && this->Kind != KIND_HAZE && this->Kind != KIND_FOG)
  {
    json["renewed"] = this->RenewedShare;
  }
  json["shape"] = NameOf("Shape", this->Shape, ShapeNames);
  if (this->Shape == SHAPE_LAYER)
  {
    json["bottom"] = this->Bottom;
    json["top"] = this->Top;
    json["softness"] = this->Softness;
  }
  if (this->Shape == SHAPE_BOX || this->Shape == SHAPE_ELLIPSOID)
  {
    json["center"] = Triple(this->Center);
    json["lengths"] = Triple(this->Lengths);
    json["heading"] = this->Heading;
  }
  if (this->Velocity[0] != 0.0 || this->Velocity[1] != 0.0 || this->Velocity[2] != 0.0)
  {
    json["velocity"] = Triple(this->Velocity);
  }
  return json.dump();
}

//------------------------------------------------------------------------------
int vtkAvianLidarMedium::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  if (vtkInformation* input = inputVector[0]->GetInformationObject(0))
  {
    input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
    input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarMedium::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]() -> std::string
    {
      if (!(this->DisplaySize > 0.0 && this->DisplaySize <= 1e9))
      {
        return avianlidar::valueError(
          "DisplaySize", this->DisplaySize, "more than 0, at most 1e9 m");
      }
      auto drawn = vtkAvianLidarMedia::Surface(
        this->Description(), vtkPolyData::GetData(inputVector[0]), this->DisplaySize);
      vtkFieldData* fields = drawn->GetFieldData();
      vtkAvianLidarArrays::SetFieldStrings(
        fields, vtkAvianLidarArrays::ObjectNames, { this->Name });
      vtkAvianLidarArrays::SetFieldStrings(fields, vtkAvianLidarArrays::ObjectClasses,
        { this->Kind == KIND_FOLIAGE ? "vegetation" : "air" });
      vtkPolyData::GetData(outputVector)->ShallowCopy(drawn);
      return {};
    });
}

//------------------------------------------------------------------------------
void vtkAvianLidarMedium::PrintSelf(ostream& os, vtkIndent indent)
{
  const auto triple = [&](const char* name, const double(&v)[3])
  { os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n"; };
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Kind: " << this->Kind << "\n";
  os << indent << "Visibility: " << this->Visibility << " m\n";
  os << indent << "RainRate: " << this->RainRate << " mm/h\n";
  os << indent << "LeafAreaDensity: " << this->LeafAreaDensity << " m2/m3\n";
  os << indent << "Extinction: " << this->Extinction << " 1/m\n";
  os << indent << "BackscatterRatio: " << this->BackscatterRatio << " sr\n";
  os << indent << "RenewedShare: " << this->RenewedShare << "\n";
  os << indent << "Shape: " << this->Shape << "\n";
  os << indent << "Bottom: " << this->Bottom << " m\n";
  os << indent << "Top: " << this->Top << " m\n";
  os << indent << "Softness: " << this->Softness << " m\n";
  triple("Center", this->Center);
  triple("Lengths", this->Lengths);
  os << indent << "Heading: " << this->Heading << " deg\n";
  triple("Velocity", this->Velocity);
  os << indent << "Name: " << this->Name << "\n";
  os << indent << "DisplaySize: " << this->DisplaySize << " m\n";
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
}
