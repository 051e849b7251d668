// SPDX-License-Identifier: BSD-3-Clause
// Picture: the town in black, the boxes of level 3 of its tree in blue.
#include "TestImages.h"

int TestImageTreeBoxes(int argc, char* argv[])
{
  return testimages::CompareTree(vtkAvianLidarCollisionTree::BOUNDING_VOLUME_AABB, argc, argv);
}
