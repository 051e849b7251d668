// SPDX-License-Identifier: BSD-3-Clause
// What the Mobile Robot Programming Toolkit finds in a KITTI scan: a line `x y z intensity` for
// each point, with the digits that give the same floats back. Its argument is the file.
#include <mrpt/maps/CPointsMapXYZI.h>

#include <cstddef>
#include <cstdio>

int main(int argc, char** argv)
{
  mrpt::maps::CPointsMapXYZI points;
  if (argc != 2 || !points.loadFromKittiVelodyneFile(argv[1]))
  {
    std::fprintf(stderr, "usage: avianlidarKittiToText <file.bin>, a KITTI scan\n");
    return 1;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    float x = 0.0f, y = 0.0f, z = 0.0f;
    points.getPoint(i, x, y, z);
    std::printf("%.9g %.9g %.9g %.9g\n", x, y, z, points.getPointIntensity(i));
  }
  return 0;
}
