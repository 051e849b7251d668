// SPDX-License-Identifier: BSD-3-Clause
// Packets of rays give the bits of a loop over all triangles with the exact functions of
// TriangleTest.h, with every instruction set of this processor: what single precision decides, it
// decides as they would. GeometryFaults.cxx has the loop; TestGeometryProperties has more scenes.
#include "GeometryCase.h"
#include "InstructionTargets.h"
#include "Sanitized.h"

#include <gtest/gtest.h>

using namespace geometrycase;

TEST(RayPacket, NastyScenesHaveTheBitsOfALoopWithEveryInstructionSet)
{
  const std::uint64_t count = IsSanitized ? 20 : 300;
  for (std::uint64_t seed = 0; seed < count; ++seed)
  {
    const GeometryCase one = fromSeed(seed);
    echotest::forEachInstructionTarget(
      [&]() { EXPECT_EQ(findFault(one), "") << "seed " << seed << '\n'
                                            << describe(one); });
  }
}
