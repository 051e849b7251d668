// SPDX-License-Identifier: BSD-3-Clause
// Picture: echoes from above, coloured by the hue of their energy (Eq. 13), with the outlines of
// the town.
#include "TestImages.h"

#include "vtkAvianLidarHSBColorMap.h"
#include "vtkLookupTable.h"

int TestImageEchoCloud(int argc, char* argv[])
{
  auto town = testimages::MakeTown();
  testimages::Scan scan(town);
  vtkNew<vtkAvianLidarHSBColorMap> colors;
  colors->SetInputConnection(scan.echoes->GetOutputPort());
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(colors->GetOutputPort());
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray("rgb");
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetPointSize(4.0);
  actor->GetProperty()->LightingOff();
  testimages::Window window;
  window.AddWireframe(scan.tree->GetOutputPort(0), 0.6, 0.6, 0.6);
  window.renderer->AddActor(actor);
  window.LookFromAbove(430.0);
  colors->Update();
  window.AddLegend(colors->GetLookupTable(), "energy (J)");
  return window.Compare(argc, argv);
}
