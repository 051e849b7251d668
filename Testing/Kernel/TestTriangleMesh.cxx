// SPDX-License-Identifier: BSD-3-Clause
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

using namespace avianlidar;
using namespace geometrytest;

TEST(TriangleMesh, ChecksumSeesEveryChange)
{
  const TriangleMesh mesh = closedSurface(1, [](const Vec3&) { return 3.0; });
  const std::uint64_t checksum = mesh.checksum();
  TriangleMesh other = mesh;
  other.points.back().z = std::nextafter(other.points.back().z, 10.0);
  EXPECT_NE(checksum, other.checksum());
  other = mesh;
  std::swap(other.triangles[0][1], other.triangles[0][2]);
  EXPECT_NE(checksum, other.checksum());
  other = mesh;
  std::swap(other.triangles[0], other.triangles[1]);
  EXPECT_NE(checksum, other.checksum());
  other = mesh;
  other.points.push_back(other.points.back());
  EXPECT_NE(checksum, other.checksum());
  other = mesh;
  other.triangles.pop_back();
  EXPECT_NE(checksum, other.checksum());
}
