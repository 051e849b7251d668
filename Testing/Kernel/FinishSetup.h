// SPDX-License-Identifier: BSD-3-Clause
// Finishes a setup as the echo filter does.
#ifndef FinishSetup_h
#define FinishSetup_h

#include "SceneSummary.h"

namespace avianlidar
{
/// Set what follows from the rest: largest values, objects, noise and needs.
inline void finishSetup(ScanSetup& setup)
{
  const SceneSummary summary = summarise(setup);
  setup.largestReflectance = summary.largestReflectance;
  setup.largestGain = summary.largestGain;
  includeMovers(setup);
  planModel(setup);
}
}

#endif
