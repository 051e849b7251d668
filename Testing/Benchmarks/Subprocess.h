// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Subprocess.h
 * @brief Runs what may crash, or may take for ever, in a copy of this process.
 */
#ifndef avianlidar_Subprocess_h
#define avianlidar_Subprocess_h

#include <functional>
#include <optional>
#include <vector>

namespace benchmarks
{
/// The numbers that `work` returns in a copy of this process, or nothing if that crashed, threw or
/// was not done after `seconds`. Call it while no other thread is at work.
std::optional<std::vector<double>> inSubprocess(
  const std::function<std::vector<double>()>& work, unsigned seconds);
}

#endif
