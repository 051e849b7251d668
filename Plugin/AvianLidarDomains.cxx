// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarInitializers.h"

#include "vtkAvianLidarMaterial.h"
#include "vtkClientServerInterpreter.h"
#include "vtkClientServerInterpreterInitializer.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkObjectFactory.h"
#include "vtkPVDataInformation.h"
#include "vtkPVXMLElement.h"
#include "vtkSMDoubleRangeDomain.h"
#include "vtkSMInputArrayDomain.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMStringListDomain.h"
#include "vtkSMUncheckedPropertyHelper.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace
{
// Sets unchecked values, which the panel shows and Apply uses.
class vtkSMAvianLidarMaterialDomain : public vtkSMDoubleRangeDomain
{
public:
  static vtkSMAvianLidarMaterialDomain* New();
  vtkTypeMacro(vtkSMAvianLidarMaterialDomain, vtkSMDoubleRangeDomain);

  // Does not call the superclass, which would use the required property's value as a new range and
  // remove the slider.
  void Update(vtkSMProperty* requesting) override
  {
    vtkSMProperty* material = this->GetRequiredProperty("Material");
    const double value = material && requesting == material
      ? vtkAvianLidarMaterial::GetMaterialCoefficient(
          vtkSMUncheckedPropertyHelper(material).GetAsInt(), this->Coefficient)
      : std::nan("");
    if (!std::isnan(value))
    {
      vtkSMUncheckedPropertyHelper(this->GetProperty()).Set(value);
    }
  }

  // The default does not change, because the range does not depend on data.
  int SetDefaultValues(vtkSMProperty*, bool) override { return 0; }

protected:
  int ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) override
  {
    return element->GetScalarAttribute("coefficient", &this->Coefficient) &&
      vtkAvianLidarMaterial::GetCoefficientName(this->Coefficient) &&
      this->Superclass::ReadXMLAttributes(property, element);
  }

private:
  int Coefficient = 0;
};

vtkStandardNewMacro(vtkSMAvianLidarMaterialDomain);

// Sets a property when the property of the same value in another unit changes. A value in the panel
// changes the value in the panel, and an applied value changes the applied value.
class vtkSMAvianLidarScaledDomain : public vtkSMDoubleRangeDomain
{
public:
  static vtkSMAvianLidarScaledDomain* New();
  vtkTypeMacro(vtkSMAvianLidarScaledDomain, vtkSMDoubleRangeDomain);

  void Update(vtkSMProperty* requesting) override
  {
    vtkSMProperty* other = this->GetRequiredProperty("Other");
    if (other && requesting == other)
    {
      this->Follow<vtkSMPropertyHelper>(other);
      this->Follow<vtkSMUncheckedPropertyHelper>(other);
    }
  }

  // The default does not change, because the range does not depend on data.
  int SetDefaultValues(vtkSMProperty*, bool) override { return 0; }

protected:
  int ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) override
  {
    return element->GetScalarAttribute("factor", &this->Factor) &&
      this->Superclass::ReadXMLAttributes(property, element);
  }

private:
  template <class Helper>
  void Follow(vtkSMProperty* other)
  {
    Helper own(this->GetProperty());
    const double wanted = this->Factor * Helper(other).GetAsDouble();
    // If the values differ only by rounding, neither value changes, and the last bit is kept.
    if (std::abs(own.GetAsDouble() - wanted) > 1e-12 * std::abs(wanted))
    {
      own.Set(wanted);
    }
  }

  double Factor = 1.0;
};

vtkStandardNewMacro(vtkSMAvianLidarScaledDomain);

// Beams of a sensor: in a scene, only beams have this point array and this field data. With this
// superclass ParaView has a message for inputs that do not fit.
class vtkSMAvianLidarBeamsDomain : public vtkSMInputArrayDomain
{
public:
  static vtkSMAvianLidarBeamsDomain* New();
  vtkTypeMacro(vtkSMAvianLidarBeamsDomain, vtkSMInputArrayDomain);

  int IsInDomain(vtkSMProperty* property) override
  {
    vtkSMUncheckedPropertyHelper helper(property);
    for (unsigned int i = 0; i < helper.GetNumberOfElements(); ++i)
    {
      auto* source = vtkSMSourceProxy::SafeDownCast(helper.GetAsProxy(i));
      vtkPVDataInformation* data =
        source ? source->GetDataInformation(helper.GetOutputPort(i)) : nullptr;
      if (!data || !data->GetArrayInformation("direction", vtkDataObject::POINT) ||
        !data->GetArrayInformation("half_beamwidth", vtkDataObject::FIELD))
      {
        return NOT_IN_DOMAIN;
      }
    }
    return IN_DOMAIN;
  }
};

vtkStandardNewMacro(vtkSMAvianLidarBeamsDomain);

// Species that the object knows, from an information property with a name in each line. The list
// always contains the present value, because the panel would replace a value that is missing.
class vtkSMAvianLidarSpeciesDomain : public vtkSMStringListDomain
{
public:
  static vtkSMAvianLidarSpeciesDomain* New();
  vtkTypeMacro(vtkSMAvianLidarSpeciesDomain, vtkSMStringListDomain);

  void Update(vtkSMProperty*) override
  {
    std::vector<std::string> names;
    const auto add = [&names](const std::string& name)
    {
      if (std::find(names.begin(), names.end(), name) == names.end())
      {
        names.push_back(name);
      }
    };
    const auto addLines = [&add](const vtkSMPropertyHelper& helper)
    {
      for (unsigned int i = 0; i < helper.GetNumberOfElements(); ++i)
      {
        std::istringstream lines(helper.GetAsString(i));
        for (std::string name; std::getline(lines, name);)
        {
          add(name);
        }
      }
    };
    if (this->HasEmpty)
    {
      add("");
    }
    if (vtkSMProperty* known = this->GetRequiredProperty("KnownSpecies"))
    {
      addLines(vtkSMPropertyHelper(known));
    }
    addLines(vtkSMPropertyHelper(this->GetProperty()));
    addLines(vtkSMUncheckedPropertyHelper(this->GetProperty()));
    this->SetStrings(names);
  }

protected:
  int ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) override
  {
    element->GetScalarAttribute("empty", &this->HasEmpty);
    // A domain cannot require its own property.
    property->AddObserver(vtkCommand::ModifiedEvent, this, &vtkSMAvianLidarSpeciesDomain::Follow);
    property->AddObserver(
      vtkCommand::UncheckedPropertyModifiedEvent, this, &vtkSMAvianLidarSpeciesDomain::Follow);
    return this->Superclass::ReadXMLAttributes(property, element);
  }

private:
  void Follow() { this->Update(nullptr); }

  int HasEmpty = 0; // whether an empty text is allowed
};

vtkStandardNewMacro(vtkSMAvianLidarSpeciesDomain);

template <class Domain>
vtkObjectBase* New(void*)
{
  return Domain::New();
}
}

//------------------------------------------------------------------------------
void AvianLidarAddDomains()
{
  auto* interpreter = vtkClientServerInterpreterInitializer::GetGlobalInterpreter();
  interpreter->AddNewInstanceFunction(
    "vtkSMAvianLidarBeamsDomain", New<vtkSMAvianLidarBeamsDomain>);
  interpreter->AddNewInstanceFunction(
    "vtkSMAvianLidarMaterialDomain", New<vtkSMAvianLidarMaterialDomain>);
  interpreter->AddNewInstanceFunction(
    "vtkSMAvianLidarScaledDomain", New<vtkSMAvianLidarScaledDomain>);
  interpreter->AddNewInstanceFunction(
    "vtkSMAvianLidarSpeciesDomain", New<vtkSMAvianLidarSpeciesDomain>);
}
