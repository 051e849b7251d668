// SPDX-License-Identifier: BSD-3-Clause
// Picture: the town in black, the oriented boxes of level 3 of its tree in blue.
#include "TestImages.h"

int TestImageTreeOrientedBoxes(int argc, char* argv[])
{
  auto town = testimages::MakeTown();
  testimages::Scan scan(town);
  scan.tree->SetBoundingVolumeToOBB();
  testimages::Window window;
  return window.CompareTree(scan.tree, argc, argv);
}
