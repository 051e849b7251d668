// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamWaveforms.h
 * @brief Records the waveforms of beams: the light before the receiver decides, as a digitiser
 * samples it, and the shapes of echoes in these samples.
 *
 * A range unit holds a whole number K of samples (Sensor::samplesOfUnit()). The mean signal of a
 * sample is the energy that the beam's paths put into the sample, plus a K-th of what the air
 * returns in the range unit. The drawn sample adds noise. The noise of the K samples of a range
 * unit adds up to the noise with which the receiver decides on this unit (BeamNoise.h). So without
 * a response time the drawn samples of a unit add up to the energy of its echo. Light that a
 * threshold subtracts as air stays in the waveform.
 *
 * A response time correlates the noise of neighbouring samples: white noise passes the response,
 * and is scaled so that the noise of a range unit keeps its variance.
 *
 * Recorded are stretches around range units whose mean signal exceeds the floor, and around
 * returns. Each stretch has a margin of one pulse. A floor of 0 records whole beams.
 *
 * The digitiser rounds drawn samples to its levels (Sensor::levelsOfDigitiser()).
 *
 * Source: S. O. Rice, "Mathematical Analysis of Random Noise", Bell Syst. Tech. J. 24, 1945, has
 * the false alarms of such noise.
 * Differs: the paper has no waveforms.
 * Valid: the mean signals of a unit's samples add up to its energy to 1e-12. The light of the air
 * changes little within a unit.
 * Test: Testing/Python/TestWaveforms.py.
 */
#ifndef avianlidar_BeamWaveforms_h
#define avianlidar_BeamWaveforms_h

#include "AirLight.h"
#include "BeamLight.h"
#include "BeamNoise.h"
#include "BeamReceiver.h"
#include "RangeUnits.h"
#include "Received.h"
#include "ScanSetup.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace avianlidar
{
/// Shape of an echo in the drawn samples of its return.
struct EchoShape
{
  double width = 0.0;     ///< full width at half the amplitude, s
  double riseTime = 0.0;  ///< time from a tenth to nine tenths of the amplitude, s
  double amplitude = 0.0; ///< greatest power, W
  double integral = 0.0;  ///< energy of the samples above a tenth of the amplitude, J
  int samples = 0;        ///< number of these samples
};

/// Waveforms of many beams, one stretch after the other.
struct Waveforms
{
  /// Memory of a sample here and in the arrays of VTK, bytes.
  static constexpr double BytesOfSample = 18.0 * sizeof(double);

  struct Stretch
  {
    std::size_t beam;   ///< index of the beam in the scan
    std::int64_t first; ///< number of the first sample since the pulse
    std::size_t begin;  ///< place of the first sample in `signal`; the stretch ends at the next
    double background;  ///< mean energy of the background in a sample, J
  };
  std::vector<Stretch> stretches;
  std::vector<double> signal;    ///< mean signal of each sample, J
  std::vector<double> drawn;     ///< drawn sample, J
  std::vector<double> received;  ///< energy with noise in the sample's range unit, J
  std::vector<double> threshold; ///< lower limit of the sample's range unit, J
  std::vector<EchoShape> shapes; ///< shapes of the echoes, one for each echo

  /// One past the last sample of a stretch.
  std::size_t endOf(std::size_t stretch) const
  {
    return stretch + 1 < this->stretches.size() ? this->stretches[stretch + 1].begin
                                                : this->signal.size();
  }
  void append(const Waveforms& more);
};

/// Records one beam after the other. Each thread needs its own object. The constructor's arguments
/// must outlive the object.
class BeamWaveforms
{
public:
  BeamWaveforms(const ScanSetup& setup, const ScanAir& air, BeamReceiver& receiver);

  /// Find what to record of a beam. @param received what the receiver makes of the light @param air
  /// air along the beam @return false if record() will add nothing
  bool find(const BeamLight& light, const Received& received, const BeamAir& air);

  /// Record a beam after find() with the same arguments. @param beam index of the beam @param
  /// divided the same light in parts of range units: how it divides the energy of a unit among
  /// samples counts
  void record(std::size_t beam, const BeamLight& light, const BeamLight& divided,
    const Received& received, Waveforms& waveforms);

private:
  /// Units [first, second).
  using Units = std::pair<std::int64_t, std::int64_t>;

  double airIn(std::int64_t unit);
  void setSignal(const BeamLight& light, std::int64_t begin, std::int64_t end);
  void recordUnits(const Units& units, const BeamLight& light, const Received& received,
    const BeamReceiver::Exposure& exposed, Waveforms& waveforms);
  void divideNoise(
    std::int64_t unit, double noise, const NoisePlan& plan, const NoiseKey& key, std::size_t place);
  double smoothed(std::size_t sample) const;
  double rounded(double sample, double upper) const;
  EchoShape shapeOf(const Received& received, const Return& run, const Waveforms& waveforms,
    std::size_t firstStretch) const;

  const ScanSetup& Setup;
  const ScanAir& Scan;
  BeamReceiver& Receiver;
  const std::int64_t PerUnit;   ///< number of samples in a range unit
  const double Interval;        ///< time of a sample, s
  const std::int64_t FirstUnit; ///< first unit inside the gate
  const std::int64_t GateUnits;
  const std::int64_t Margin;   ///< units recorded before and after what is above the floor
  std::int64_t AirUnits = 0;   ///< units in which air that fills the scene may exceed the floor
  std::vector<double> Kernel;  ///< response from sample 0 to one side, scaled; empty: none
  std::int64_t NoiseUnits = 0; ///< units whose noise reaches a unit, on each side
  // Memory of the beams before.
  RangeUnitAccumulator Fine;
  AirLight Air;
  BeamNoise Noise;
  std::vector<Units> Found;
  std::vector<double> Signal;
  std::vector<double> White; ///< noise before the response, J
};
}

#endif
