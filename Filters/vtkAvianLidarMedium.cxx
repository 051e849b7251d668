// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarMedium.h"

#include "JsonNode.h"
#include "ValueError.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarMedia.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"

#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkAvianLidarMedium);

namespace
{
using vtkAvianLidarMedia::Word;

const Word& Chosen(const char* property, int value, const std::vector<Word>& all)
{
  const int last = static_cast<int>(all.size()) - 1;
  vtkAvianLidarRequire(
    avianlidar::rangeError(property, value, 0, last, "0 to " + std::to_string(last)));
  return all[value];
}

bool Has(const Word& word, const std::string& key)
{
  return std::find(word.keys.begin(), word.keys.end(), key) != word.keys.end();
}

avianlidar::Json Triple(const double (&v)[3])
{
  return { v[0], v[1], v[2] };
}
}

//------------------------------------------------------------------------------
int vtkAvianLidarMedium::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
/// Description as JSON, with the values that belong to the kind and the shape.
std::string vtkAvianLidarMedium::Description() const
{
  const Word& kind = Chosen("Kind", this->Kind, vtkAvianLidarMedia::Kinds());
  const Word& shape = Chosen("Shape", this->Shape, vtkAvianLidarMedia::Shapes());
  const std::pair<const char*, avianlidar::Json> values[] = { { "visibility", this->Visibility },
    { "rain_rate", this->RainRate }, { "leaf_area_density", this->LeafAreaDensity },
    { "extinction", this->Extinction }, { "backscatter_ratio", this->BackscatterRatio },
    { "bottom", this->Bottom }, { "top", this->Top }, { "softness", this->Softness },
    { "center", Triple(this->Center) }, { "lengths", Triple(this->Lengths) },
    { "heading", this->Heading } };
  avianlidar::Json json;
  const auto add = [&](const Word& word)
  {
    for (const auto& [key, value] : values)
    {
      if (Has(word, key))
      {
        json[key] = value;
      }
    }
  };
  json["kind"] = kind.name;
  json["name"] = this->Name;
  add(kind);
  if (this->RenewedShare != -1.0 && Has(kind, "renewed"))
  {
    json["renewed"] = this->RenewedShare;
  }
  json["shape"] = shape.name;
  add(shape);
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
  vtkAvianLidarRanks::RequestAll(inputVector[0]);
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarMedium::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkAvianLidarRequire(avianlidar::rangeError("DisplaySize", this->DisplaySize,
        avianlidar::AboveZero, 1e9, "more than 0, at most 1e9 m"));
      auto drawn = vtkAvianLidarMedia::Surface(
        this->Description(), vtkPolyData::GetData(inputVector[0]), this->DisplaySize);
      vtkFieldData* fields = drawn->GetFieldData();
      vtkAvianLidarArrays::SetFieldStrings(
        fields, vtkAvianLidarArrays::ObjectNames, { this->Name });
      const bool isObject = Has(vtkAvianLidarMedia::Kinds()[this->Kind], "object_id");
      vtkAvianLidarArrays::SetFieldStrings(
        fields, vtkAvianLidarArrays::ObjectClasses, { isObject ? "vegetation" : "air" });
      vtkPolyData::GetData(outputVector)->ShallowCopy(drawn);
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
