// SPDX-License-Identifier: BSD-3-Clause
// Picture: the town in black, the boxes of level 3 of its tree in blue.
#include "TestImages.h"

int TestImageTreeBoxes(int argc, char* argv[])
{
  auto town = testimages::MakeTown();
  testimages::Scan scan(town);
  scan.tree->SetDisplayLevel(3);
  testimages::Window window;
  window.AddWireframe(scan.tree->GetOutputPort(0), 0.0, 0.0, 0.0);
  window.AddWireframe(scan.tree->GetOutputPort(1), 0.1, 0.3, 0.9);
  vtkCamera* camera = window.renderer->GetActiveCamera();
  camera->SetPosition(0.0, -330.0, 220.0);
  camera->SetFocalPoint(0.0, 0.0, 0.0);
  camera->SetViewUp(0.0, 0.0, 1.0);
  window.renderer->ResetCameraClippingRange();
  return window.Compare(argc, argv);
}
