// SPDX-License-Identifier: BSD-3-Clause
// Picture: the town in black, the spheres of level 3 of its tree in blue.
#include "TestImages.h"

int TestImageTreeSpheres(int argc, char* argv[])
{
  auto town = testimages::MakeTown();
  testimages::Scan scan(town);
  scan.tree->SetBoundingVolumeToSphere();
  testimages::Window window;
  return window.CompareTree(scan.tree, argc, argv);
}
