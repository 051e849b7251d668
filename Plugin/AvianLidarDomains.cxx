// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarInitializers.h"

#include "vtkAvianLidarMaterial.h"
#include "vtkClientServerInterpreter.h"
#include "vtkClientServerInterpreterInitializer.h"
#include "vtkDataObject.h"
#include "vtkObjectFactory.h"
#include "vtkPVDataInformation.h"
#include "vtkPVXMLElement.h"
#include "vtkSMDoubleRangeDomain.h"
#include "vtkSMInputArrayDomain.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMUncheckedPropertyHelper.h"

#include <cmath>

namespace
{
// What the panel shows are unchecked values, which Apply takes over.
class vtkSMAvianLidarMaterialDomain : public vtkSMDoubleRangeDomain
{
public:
  static vtkSMAvianLidarMaterialDomain* New();
  vtkTypeMacro(vtkSMAvianLidarMaterialDomain, vtkSMDoubleRangeDomain);

  // The superclass would take the required property's value for a new range, and the slider would
  // go.
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

  // A range that depends on nothing leaves the default as it is.
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

// Sets a property when another one, of the same value in another unit, changes: what the panel
// shows with what it shows, what is applied with what is applied.
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

  // A range that depends on nothing leaves the default as it is.
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
    // The two are the same but for rounding: neither changes then, and the last bit is kept.
    if (std::abs(own.GetAsDouble() - wanted) > 1e-12 * std::abs(wanted))
    {
      own.Set(wanted);
    }
  }

  double Factor = 1.0;
};

vtkStandardNewMacro(vtkSMAvianLidarScaledDomain);

// Beams of a sensor: of what a scene may hold, only they have this point array and this field. The
// superclass is for the words that ParaView has where it does not fit.
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
}
