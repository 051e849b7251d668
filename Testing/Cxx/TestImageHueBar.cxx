// SPDX-License-Identifier: BSD-3-Clause
// Picture: the hue bar, blue at the lower and red at the upper energy limit.
#include "TestImages.h"

#include "vtkAvianLidarHSBColorMap.h"
#include "vtkLookupTable.h"
#include "vtkScalarBarActor.h"
#include "vtkTextProperty.h"

int TestImageHueBar(int argc, char* argv[])
{
  auto town = testimages::MakeTown();
  testimages::Scan scan(town);
  vtkNew<vtkAvianLidarHSBColorMap> colors;
  colors->SetInputConnection(scan.echoes->GetOutputPort());
  colors->Update();
  vtkNew<vtkLookupTable> table;
  colors->FillLookupTable(table);
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(table);
  bar->SetTitle("Energy (J)");
  bar->SetLabelFormat("%.2e");
  bar->SetNumberOfLabels(5);
  bar->UnconstrainedFontSizeOn();
  bar->SetVerticalTitleSeparation(12);
  for (vtkTextProperty* text : { bar->GetLabelTextProperty(), bar->GetTitleTextProperty() })
  {
    text->SetColor(0.0, 0.0, 0.0);
    text->SetFontSize(16);
    text->ItalicOff();
    text->ShadowOff();
  }
  bar->SetPosition(0.3, 0.05);
  bar->SetWidth(0.4);
  bar->SetHeight(0.9);
  testimages::Window window;
  window.renderer->AddActor2D(bar);
  return window.Compare(argc, argv);
}
