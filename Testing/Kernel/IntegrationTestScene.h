// SPDX-License-Identifier: BSD-3-Clause
// What the tests of integrated beams share.
#ifndef IntegrationTestScene_h
#define IntegrationTestScene_h

#include "EchoTestScene.h"

namespace echotest
{
/// So many rays that any integral takes less time.
constexpr int Very = 10000;

inline EchoSettings integrating()
{
  return inCells(Very);
}

/// The one beam of a scan, or its first.
inline bool isIntegrated(const ScanResult& result)
{
  return result.reports[0].direct == DirectEcho::Polygons;
}
}

#endif
