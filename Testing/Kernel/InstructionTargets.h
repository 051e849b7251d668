// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file InstructionTargets.h
 * @brief The same check with every instruction set of this processor that Highway has code for.
 */
#ifndef avianlidar_InstructionTargets_h
#define avianlidar_InstructionTargets_h

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cstdint>

namespace echotest
{
/// Calls `check` once for each, from plain C++ to the best.
template <class Check>
void forEachInstructionTarget(Check&& check)
{
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
  {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    check();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}
}

#endif
