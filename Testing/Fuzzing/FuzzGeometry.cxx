// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target: any bytes are a scene with a beam (GeometryCase.h), of which the properties
// must hold that TestGeometryProperties.cxx checks with drawn ones.
#include "GeometryCase.h"

#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const geometrycase::GeometryCase one = geometrycase::fromBytes(data, size);
  const std::string fault = geometrycase::findFault(one);
  if (!fault.empty())
  {
    std::fprintf(stderr, "%s\n%s\n", fault.c_str(), geometrycase::describe(one).c_str());
    std::abort();
  }
  return 0;
}
