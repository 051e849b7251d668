// SPDX-License-Identifier: BSD-3-Clause
// Picture: the town in black, the spheres of level 3 of its tree in blue.
#include "TestImages.h"

int TestImageTreeSpheres(int argc, char* argv[])
{
  return testimages::CompareTree(vtkAvianLidarCollisionTree::BOUNDING_VOLUME_SPHERE, argc, argv);
}
