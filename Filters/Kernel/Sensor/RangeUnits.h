// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeUnits.h
 * @brief Sums the energies of all paths of a beam in range units (range bins), without the noise.
 *
 * A path of length l arrives after tau = l/c. Its energy arrives as a rectangular pulse of width
 * tau_e centred on tau and is divided, exactly and in proportion, among the units m, [m tau_s,
 * (m+1) tau_s), that it overlaps; tau_e = 0 is a delta at tau. What would arrive before the pulse
 * is sent, closer than c tau_e/4, is counted in unit 0. A path shorter than twice the minimum range
 * is not recorded.
 *
 * Units are sparse: memory follows contributions and the units that they meet, at most (1 +
 * tau_e/tau_s) each, not the range. Sums run in the order in which contributions were given.
 *
 * Source: paper, Eq. 10.
 * Differs: the paper does not place the pulse. A pulse that starts at tau would move every echo c
 * tau_e/4 away, so it is centred.
 * Valid: tau_e from 0 to 1000 tau_s. The sum over units is the sum over paths to round-off.
 * Test: TestRangeUnits.cxx, TestRangeShares.cxx.
 */
#ifndef avianlidar_RangeUnits_h
#define avianlidar_RangeUnits_h

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
struct PulseLanes;

/// Energy that came back along one path.
struct Contribution
{
  double pathLength = 0.0; ///< m, the whole way out and back
  double energy = 0.0;     ///< J; contributions of 0 are left out
};

/// Energies that contributions put into some consecutive range units, in their order: of all
/// contributions, or only of those that put something there.
struct RangeShares
{
  const double* energies = nullptr;     ///< J
  const std::uint32_t* which = nullptr; ///< contribution of each; null: all, and 0 of some
  std::size_t count = 0;

  std::size_t contribution(std::size_t share) const
  {
    return this->which ? this->which[share] : share;
  }
};

/// A range unit that received energy.
struct RangeUnit
{
  std::int64_t index = 0;  ///< m
  double energy = 0.0;     ///< J, sum of its shares
  std::uint32_t paths = 0; ///< contributions that have a share in it
};

/// Reusable: allocates nothing once its workspace has grown to the largest beam. One per thread.
///
/// Pulses no wider than a unit meet two units at most. They are placed in a loop over lanes and
/// added to a table of units without a branch: some ns each. The shares of paths are found from
/// that on request: most beams are not perceived, or give one return, for which receiver and labels
/// request the same shares.
class RangeUnitAccumulator
{
public:
  /// @param samplingInterval tau_s, s, > 0 @param pulseWidth tau_e, s, in [0, 1000 tau_s]
  /// @param rangeGate m, > 0: units that begin at or beyond it are dropped (see gateUnits())
  /// @param minimumRange m: nearer contributions are dropped
  RangeUnitAccumulator(
    double samplingInterval, double pulseWidth, double rangeGate, double minimumRange = 0.0);

  /// Forget the previous beam.
  void clear();

  /// Add a path of the beam. Length and energy must be finite, energy >= 0.
  void add(const Contribution& contribution);

  /// Add `count` paths: half their lengths (m) and energies (J).
  void add(const double* ranges, const double* energies, std::size_t count);

  /// Distribute everything added since clear() over the units.
  void accumulate();

  /// Units with energy in ascending order of index, each once.
  const std::vector<RangeUnit>& units() const { return this->Units; }

  /// Shares of the paths in units [first, last), which must lie inside the gate. After
  /// accumulate(); after clear() there are none. Valid until the next call.
  RangeShares sharesOf(std::int64_t first, std::int64_t last);

  /// Lengths (m) of the contributions, after accumulate().
  const std::vector<double>& pathLengths() const { return this->Lengths; }

  /// Energy that arrived beyond the gate, J.
  double energyBeyondGate() const { return this->EnergyBeyondGate; }

  /// Energy that arrived before the gate, J.
  double energyBeforeGate() const { return this->EnergyBeforeGate; }

  /// Units inside the gate: 0 <= m < gateUnits().
  std::int64_t gateUnits() const { return this->GateUnits; }

  /// The last unit that a path of this range can reach; not limited to gateUnits().
  double lastUnitOf(double range) const;

private:
  /// Energy that a contribution put into the requested units.
  struct Portion
  {
    std::uint32_t contribution;
    double energy;
  };
  /// A unit of the table.
  struct Cell
  {
    double energy = 0.0;
    std::uint32_t paths = 0;
  };
  void clearUnits();
  PulseLanes pulses() const;
  void accumulateNarrow(double lowest, std::uint32_t window);
  void takeCells(std::int64_t lowest, std::uint32_t window);
  void accumulateWide(double lowest);
  void sumBeyondGate();
  double recorded(double length, double energy);
  double addToTable(double from, double to, std::size_t& next);
  void sortByFirst();
  void findShares(double from, double to);
  void findSharesAmongFew(double from, double to);

  double UnitPathLength; // c tau_s: twice a unit's length in range
  double RelativeWidth;  // tau_e/tau_s
  std::int64_t GateUnits;
  double LeastLength; // m
  double EnergyBeforeGate = 0.0;
  double EnergyBeyondGate = 0.0;

  // Contributions, in lanes.
  std::vector<double> Lengths;
  std::vector<double> Energies;
  // Where their pulses lie: beginning and width, in units, first and last unit.
  std::vector<double> Begins;
  std::vector<double> Widths;
  std::vector<double> Firsts;
  std::vector<double> Lasts;
  std::vector<double> Portions; ///< shares requested last, in units [ShareFirst, ShareLast)
  // For pulses that meet two units at most: cell and energy of the first, energy of the next.
  std::vector<std::uint32_t> Places;
  std::vector<double> Here;
  std::vector<double> Next;
  bool Narrow = false;       ///< these three belong to the beam
  double LowestNarrow = 0.0; ///< unit of cell 0

  std::vector<RangeUnit> Units;
  std::vector<Cell> Table;            ///< of a window of units; zero between beams
  std::vector<std::uint64_t> Marks;   ///< a bit for each cell at which pulses begin; likewise
  int Requests = 0;                   ///< of shares, since accumulate()
  std::vector<std::uint32_t> ByFirst; ///< contributions by first unit, made when needed
  bool FewAsked = false;              ///< the shares requested last are those of `Few`, not of all
  std::vector<Portion> FewPortions;   ///< above 0
  std::vector<std::uint32_t> Few;     ///< contributions; their shares are in Portions
  std::int64_t ShareFirst = 0;
  std::int64_t ShareLast = 0;
};

/// Number of range units whose beginning lies inside the gate: ceil(2 gate/(c tau_s)), at least 1.
std::int64_t unitsInsideGate(double samplingInterval, double rangeGate);

/// The unit in which the gate begins, floor(2 minimum/(c tau_s)): those before it receive nothing.
std::int64_t firstUnitInsideGate(double samplingInterval, double minimumRange);
}

#endif
