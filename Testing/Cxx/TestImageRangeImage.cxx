// SPDX-License-Identifier: BSD-3-Clause
// Picture: azimuth x elevation, coloured by the distance of the strongest return; white where
// nothing came back.
#include "TestImages.h"

#include "vtkAvianLidarRangeImage.h"
#include "vtkCamera.h"
#include "vtkImageActor.h"
#include "vtkImageData.h"
#include "vtkImageMapToColors.h"
#include "vtkImageMapper3D.h"
#include "vtkLookupTable.h"
#include "vtkPointData.h"

int TestImageRangeImage(int argc, char* argv[])
{
  auto town = testimages::MakeTown();
  testimages::Scan scan(town);
  vtkNew<vtkAvianLidarRangeImage> image;
  image->SetInputConnection(0, scan.echoes->GetOutputPort());
  image->SetInputConnection(1, scan.beams->GetOutputPort());
  image->Update();
  vtkNew<vtkImageData> distances;
  distances->ShallowCopy(image->GetOutput());
  distances->GetPointData()->SetActiveScalars("distance_m");
  distances->SetSpacing(1.0, 8.0, 1.0); // rows tall enough to see
  vtkNew<vtkLookupTable> table;
  table->SetRange(40.0, 120.0);
  table->SetHueRange(0.0, 0.67);
  table->SetNanColor(1.0, 1.0, 1.0, 1.0);
  table->Build();
  vtkNew<vtkImageMapToColors> colors;
  colors->SetInputData(distances);
  colors->SetLookupTable(table);
  vtkNew<vtkImageActor> actor;
  actor->GetMapper()->SetInputConnection(colors->GetOutputPort());
  actor->InterpolateOff();
  testimages::Window window;
  window.renderer->SetBackground(0.5, 0.5, 0.5);
  window.renderer->AddActor(actor);
  window.AddLegend(table, "distance (m)", true);
  window.renderer->GetActiveCamera()->ParallelProjectionOn();
  window.renderer->ResetCamera();
  window.renderer->GetActiveCamera()->Zoom(1.6);
  return window.Compare(argc, argv);
}
