// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeUnits.h
 * @brief Sums the energies of all paths of a beam in range units (range bins), without the noise.
 *
 * Light on a path of length l arrives after the time tau = l/c. The energy of the path arrives as a
 * pulse whose mean time is tau (ReceivedPulse.h), by default a rectangle of width tau_e. This
 * energy is divided among the units m, [m tau_s, (m+1) tau_s), that the pulse overlaps, exactly and
 * in proportion to what arrives in each. A width of 0 gives a delta pulse at tau. Energy that would
 * arrive before the pulse is sent, from closer than c tau_e/4, is counted in the unit m = 0. A path
 * shorter than twice the minimum range is not recorded.
 *
 * Only units with energy are stored. Memory grows with the numbers of contributions and of the
 * units that they meet (on average 1 + tau_e/tau_s per contribution), and not with the range. Sums
 * run in the order of the contributions.
 *
 * Source: paper, Eq. 10.
 * Differs: the paper does not place the pulse. A pulse that starts at tau would move every echo c
 * tau_e/4 away, so the pulse is centred.
 * Valid: tau_e from 0 to 1000 tau_s. The sum over units equals the sum over paths up to rounding.
 * Test: TestRangeUnits.cxx.
 */
#ifndef avianlidar_RangeUnits_h
#define avianlidar_RangeUnits_h

#include "ReceivedPulse.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Energy that came back along one path.
struct Contribution
{
  double pathLength = 0.0; ///< length of the whole way out and back, m
  double energy = 0.0;     ///< received energy, J; contributions of 0 J are left out
};

/// A range unit that received energy.
struct RangeUnit
{
  std::int64_t index = 0;  ///< number m of the unit
  double energy = 0.0;     ///< sum of the unit's shares, J
  std::uint32_t paths = 0; ///< number of contributions with a share
};

/// Sums the contributions of one beam after the other. An object allocates nothing once its
/// workspace has grown to the largest beam. Each thread needs its own object.
///
/// Pulses are placed in a loop over lanes, and are added one by one to a table, which holds a
/// window of units. If a beam's units lie farther apart than the table is long, the window moves to
/// the next unit that a pulse meets.
class RangeUnitAccumulator
{
public:
  /// @param samplingInterval sampling interval tau_s, s, > 0 @param pulseWidth width tau_e, s, in
  /// [0, 1000 tau_s]
  /// @param rangeGate end of the gate, m, > 0, before which all recorded units begin
  /// @param minimumRange beginning of the gate, m. Contributions from outside the gate are dropped.
  RangeUnitAccumulator(
    double samplingInterval, double pulseWidth, double rangeGate, double minimumRange = 0.0);
  /// Accumulator of a sensor's light. @param parts number of parts of equal length into which each
  /// range unit is divided. A part then counts as a unit.
  explicit RangeUnitAccumulator(const Sensor& sensor, double parts = 1.0);

  /// Remove the contributions of the previous beam.
  void clear();

  /// Add a path of the beam. Length and energy must be finite, and the energy must be at least 0.
  void add(const Contribution& contribution);

  /// Add `count` paths. @param ranges half the length of each path, m @param energies energies, J
  void add(const double* ranges, const double* energies, std::size_t count);

  /// Take the contributions of another accumulator of the same sensor, in place of one's own.
  void take(const RangeUnitAccumulator& other)
  {
    this->clear();
    this->Lengths = other.Lengths;
    this->Energies = other.Energies;
  }

  /// Distribute all contributions added since clear() among the units.
  void accumulate();

  /// Units with energy in ascending order of index, each unit once.
  const std::vector<RangeUnit>& units() const { return this->Units; }

  /// Pulses of the contributions, after accumulate(), one entry per contribution. Places and widths
  /// are in units.
  struct Pulses
  {
    const std::vector<double>& energies; ///< energies, J; 0: not recorded
    const std::vector<double>& begins;
    const std::vector<double>& widths;
    const std::vector<double>& firsts; ///< first unit that the pulse meets
    const std::vector<double>& lasts;  ///< last unit that the pulse meets
    const ReceivedPulse& shape;
  };
  Pulses pulses() const
  {
    return { this->Energies, this->Begins, this->Widths, this->Firsts, this->Lasts, this->Pulse };
  }

  /// Lengths (m) of the contributions, after accumulate().
  const std::vector<double>& pathLengths() const { return this->Lengths; }

  /// Energy that arrived beyond the gate, J.
  double energyBeyondGate() const { return this->EnergyBeyondGate; }

  /// Energy that arrived before the gate, J.
  double energyBeforeGate() const { return this->EnergyBeforeGate; }

  /// Number of units m inside the gate: 0 <= m < gateUnits().
  std::int64_t gateUnits() const { return this->GateUnits; }

  /// The last unit that a path of this range (m) can reach; not limited to gateUnits().
  double lastUnitOf(double range) const;

  /// Largest energy of a unit that contribution `number` meets, J. Requires accumulate().
  double mostAround(std::size_t number) const;

private:
  double recorded(double length, double energy);
  template <bool IsRectangle>
  double addWindow(double from, double to);

  double UnitPathLength; // length of path in a unit, c tau_s, m
  ReceivedPulse Pulse;   // in units
  std::int64_t GateUnits;
  double LeastLength;      // least length of a recorded path, m
  double MostLength;       // greatest length of a recorded path, m
  double LateEnergy = 0.0; // energy of longer paths, J
  double EnergyBeforeGate = 0.0;
  double EnergyBeyondGate = 0.0;

  // Contributions, in lanes.
  std::vector<double> Lengths;
  std::vector<double> Energies;
  // Places of the contributions' pulses: beginning and width, in units, first and last unit.
  std::vector<double> Begins;
  std::vector<double> Widths;
  std::vector<double> Firsts;
  std::vector<double> Lasts;
  std::vector<double> Heads; ///< share of each pulse in its first unit

  std::vector<RangeUnit> Units;
  std::vector<RangeUnit> Table; ///< sums of a window of units; zero between beams
  std::vector<std::uint64_t>
    Marks; ///< bits of the table's units, 1 for units with a share; 0 between beams
};
}

#endif
