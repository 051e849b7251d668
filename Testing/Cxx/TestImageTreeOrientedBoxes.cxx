// SPDX-License-Identifier: BSD-3-Clause
// Picture: the town in black, the oriented boxes of level 3 of its tree in blue.
#include "TestImages.h"

int TestImageTreeOrientedBoxes(int argc, char* argv[])
{
  return testimages::CompareTree(vtkAvianLidarCollisionTree::BOUNDING_VOLUME_OBB, argc, argv);
}
