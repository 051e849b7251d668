// SPDX-License-Identifier: BSD-3-Clause
// One scan through the whole pipeline in C++ and what may follow it: scene, material, tree, echoes,
// lit again, other beams, noise, bad input. Numbers are tested elsewhere: this is the path that is
// also walked under AddressSanitizer.
#include "vtkAvianLidarBeamSource.h"
#include "vtkAvianLidarCollisionTree.h"
#include "vtkAvianLidarEchoFilter.h"
#include "vtkAvianLidarHSBColorMap.h"
#include "vtkAvianLidarMaterial.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarRangeImage.h"

#include "Checks.h"
#include "vtkCubeSource.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSphereSource.h"

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using checks::Check;

/// Sum of an array of the echoes.
double Sum(vtkAvianLidarEchoFilter* filter, const char* name)
{
  vtkDataArray* array = filter->GetOutput()->GetPointData()->GetArray(name);
  double sum = 0.0;
  for (vtkIdType i = 0; array && i < array->GetNumberOfTuples(); ++i)
  {
    sum += array->GetComponent(i, 0);
  }
  return sum;
}

/// The echoes of a filter without a past, with the same properties.
double Fresh(vtkAvianLidarEchoFilter* filter)
{
  vtkNew<vtkAvianLidarEchoFilter> other;
  other->SetInputConnection(0, filter->GetInputConnection(0, 0));
  other->SetInputConnection(1, filter->GetInputConnection(1, 0));
  other->SetAttenuationCoefficient(filter->GetAttenuationCoefficient());
  other->SetNumberOfReflections(filter->GetNumberOfReflections());
  other->SetRaysPerBeam(filter->GetRaysPerBeam());
  other->SetNumberOfThreads(1);
  other->Update();
  return Sum(other, Arrays::ReturnEnergy.name);
}
}

int TestEchoFilter(int, char*[])
{
  vtkNew<vtkAvianLidarBeamSource> beams;
  beams->SetAzimuthStep(4.0);
  beams->SetNumberOfChannels(4);
  vtkNew<vtkSphereSource> dome;
  dome->SetRadius(80.0);
  dome->SetThetaResolution(60);
  dome->SetPhiResolution(40);
  vtkNew<vtkAvianLidarMaterial> material;
  material->SetInputConnection(dome->GetOutputPort());
  material->SetMaterialToGlass();
  vtkNew<vtkAvianLidarCollisionTree> tree;
  tree->SetInputConnection(material->GetOutputPort());
  vtkNew<vtkAvianLidarEchoFilter> echoes;
  echoes->SetInputConnection(0, beams->GetOutputPort());
  echoes->SetInputConnection(1, tree->GetOutputPort());
  echoes->SetNumberOfThreads(4);
  echoes->SetRaysPerBeam(50);

  echoes->Update();
  Check(echoes->GetOutput()->GetNumberOfPoints() == 4 * 90, "every beam meets the dome once");
  const double energy = Sum(echoes, Arrays::ReturnEnergy.name);
  Check(energy > 0.0 && energy == Fresh(echoes), "four threads give what one gives");

  echoes->SetAttenuationCoefficient(1e-3);
  echoes->Update();
  Check(Sum(echoes, Arrays::ReturnEnergy.name) < energy, "air takes energy");
  Check(Sum(echoes, Arrays::ReturnEnergy.name) == Fresh(echoes), "lit again as lit anew");
  material->SetMaterialToWall();
  echoes->Update();
  Check(Sum(echoes, Arrays::ReturnEnergy.name) == Fresh(echoes), "repainted as painted anew");
  dome->SetRadius(60.0);
  beams->SetNumberOfChannels(2);
  echoes->Update();
  Check(Sum(echoes, Arrays::ReturnEnergy.name) == Fresh(echoes), "another scene, other beams");

  vtkNew<vtkAvianLidarHSBColorMap> colours;
  colours->SetInputConnection(echoes->GetOutputPort());
  colours->Update();
  vtkNew<vtkAvianLidarRangeImage> image;
  image->SetInputConnection(0, echoes->GetOutputPort());
  image->SetInputConnection(1, beams->GetOutputPort());
  image->Update();
  Check(image->GetOutput()->GetNumberOfPoints() > 0, "a range image");

  // Noise of some photons in each unit against a limit of some more, and one return of each beam.
  beams->SetNoisePhotonRate(1e9);
  beams->SetLowerEnergyLimit(3e-18);
  echoes->SetReturnModeToStrongest();
  echoes->Update();
  Check(echoes->GetOutput()->GetNumberOfPoints() == 2 * 90, "the strongest return of each beam");

  checks::Heard heard(echoes);
  echoes->SetRaysPerBeam(0);
  echoes->Update();
  Check(heard.ErrorHas("RaysPerBeam"), "no rays are an error");
  Check(echoes->GetOutput()->GetNumberOfPoints() == 0, "and give nothing");
  return checks::Result();
}
