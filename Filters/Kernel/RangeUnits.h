// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeUnits.h
 * @brief Sums the energies of all paths of a beam in range units (paper, Eq. 10, without the
 * noise).
 *
 * A path of length l arrives after tau = l/c. Its energy arrives as a rectangular pulse of width
 * tau_e centred on tau and is spread, exactly and in proportion, over the units m, [m tau_s, (m+1)
 * tau_s), that it overlaps; tau_e = 0 is a delta at tau. Energy is conserved over m to round-off.
 * (The paper gives no place of the pulse: a pulse that starts at tau would move every echo c
 * tau_e/4 away.) What would arrive before the pulse is sent, closer than c tau_e/4, is counted in
 * unit 0.
 *
 * Units are sparse: memory follows contributions (1 + tau_e/tau_s), not the range. Sums run in the
 * order of the path number, then length, then energy, whatever the order in which contributions
 * were given: the result is the same bits.
 */
#ifndef avianlidar_RangeUnits_h
#define avianlidar_RangeUnits_h

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Energy that came back along one path.
struct Contribution
{
  double pathLength = 0.0; ///< m, the whole way out and back
  double energy = 0.0;     ///< J; contributions of 0 are left out
  std::uint32_t path =
    0; ///< the caller's number of ray and kind of path; fixes the order of summation
};

/// What a contribution puts into one range unit.
struct RangeShare
{
  double energy = 0.0;     ///< J
  double pathLength = 0.0; ///< m, of the contribution
  std::uint32_t path = 0;  ///< of the contribution
};

/// A range unit that received energy.
struct RangeUnit
{
  std::int64_t index = 0; ///< m
  double energy = 0.0;    ///< J, sum of its shares
  std::size_t first = 0;  ///< its shares are [first, last) of shares()
  std::size_t last = 0;
};

/// Reusable: allocates nothing once its workspace has grown to the largest beam. One per thread.
class RangeUnitAccumulator
{
public:
  /// @param samplingInterval tau_s, s, > 0 @param pulseWidth tau_e, s, in [0, 1000 tau_s]
  /// @param rangeGate m, > 0: units that begin at or beyond it are dropped (see gateUnits())
  RangeUnitAccumulator(double samplingInterval, double pulseWidth, double rangeGate);

  /// Forget the previous beam.
  void clear();

  /// Add a path of the beam, in any order. Length and energy must be finite, energy >= 0.
  void add(const Contribution& contribution) { this->Contributions.push_back(contribution); }

  /// Distribute everything added since clear() over the units.
  void accumulate();

  /// Units with energy in ascending order of index, each once.
  const std::vector<RangeUnit>& units() const { return this->Units; }

  /// Shares, unit by unit, in the order of summation.
  const std::vector<RangeShare>& shares() const { return this->Shares; }

  /// Energy that arrived beyond the gate, J.
  double energyBeyondGate() const { return this->EnergyBeyondGate; }

  /// Units inside the gate: 0 <= m < gateUnits().
  std::int64_t gateUnits() const { return this->GateUnits; }

private:
  struct Entry
  {
    std::int64_t unit;
    std::uint32_t contribution;
    double energy;
  };
  void spread();
  void sortEntries();

  double UnitPathLength; // c tau_s: twice a unit's length in range
  double RelativeWidth;  // tau_e/tau_s
  std::int64_t GateUnits;
  double EnergyBeyondGate = 0.0;
  std::vector<Contribution> Contributions;
  std::vector<Entry> Entries;
  std::vector<Entry> Sorted;
  std::vector<std::uint32_t> Counts;
  std::vector<RangeUnit> Units;
  std::vector<RangeShare> Shares;
};

/// Number of range units whose beginning lies inside the gate: ceil(2 gate/(c tau_s)), at least 1.
std::int64_t unitsInsideGate(double samplingInterval, double rangeGate);
}

#endif
