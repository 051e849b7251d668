// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamEchoes.h
 * @brief Third stage of a beam: from energies in range units to returns with labels and standard
 * errors (paper, Eq. 10-12).
 */
#ifndef avianlidar_BeamEchoes_h
#define avianlidar_BeamEchoes_h

#include "BeamLighting.h"
#include "EchoLabels.h"

#include <vector>

namespace avianlidar
{
/// One per thread. What the constructor is given must outlive it.
class BeamEchoes
{
public:
  BeamEchoes(const ScanSetup& setup, BeamLighting& lighting, BeamReceiver& receiver);

  /// Append the echoes of the beam lit last. @param beam its id @param report gets status and range
  void receive(std::uint64_t beam, std::vector<Echo>& echoes, BeamReport& report);

private:
  Echo makeEcho(const Return& ret);
  BeamStatus statusOf() const;

  const ScanSetup& Setup;
  BeamLighting& Lighting;
  BeamReceiver& Receiver;
  EchoLabels Labels;
};
}

#endif
