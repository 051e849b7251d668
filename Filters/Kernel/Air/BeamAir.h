// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamAir.h
 * @brief The air along one beam: what it leaves of the light, and what it sends back in each range
 * unit, of which surfaces take their share.
 *
 * From the range R1 to R2 a medium returns E mu/S times the integral over R of O(R) min(A/R^2, 2
 * pi) exp(-depth(R)): A the aperture, O what reaches the detector of the near range, depth the
 * optical depth of all air on the way there and back. Where media fill the scene this is a table of
 * units, and only the share of the pulse counts that no nearer surface has met.
 *
 * Of a beam that meets volumes its axis counts, if they are wider than it and its rim crosses them
 * where the axis does, and as deep. Else it is divided into columns, each with a direction, a share
 * of the pulse, and the parts in which it crosses the volumes (MediumVolume.h): the cells of a grid
 * of eight by eight over its plane, or of layers alone, eight rows. A sample knows the columns that
 * its rays lie in (BeamSamples::columns). So light behind half a tree is weakened where the tree
 * is, and a tree behind half a wall returns what the wall leaves.
 *
 * Leaves stop light on its way there and on its way back, but a leaf that would stop both counts
 * once. Light returns to any point of the aperture, a disc about the apex: at a range z its way
 * back lies q (1 - z/R) beside its way there, q the distance of that point from the apex, R the
 * range of what returns the light. Discs of diameter d that face all ways stop both of two ways, x
 * d apart, (1 - x)^2 times as often as one of them, and never beyond x = 1. So leaves let exp(-mu
 * int (2 - (1 - x)^2) dz) come back, averaged over the aperture: from exp(-mu L), where the
 * aperture is much smaller than a leaf, to exp(-2 mu L).
 *
 * Units are looked at where media may be perceived: in their parts, as far as they return more than
 * a millionth of the lower limit.
 *
 * Source: the lidar equation, single scattering, e.g. U. Wandinger, in: Lidar, Springer, 2005; the
 * hot spot of leaves: A. Kuusk, Soviet Journal of Remote Sensing 3, 1985 (second-hand).
 * Differs: the paper's air sends nothing back. Kuusk has exp(-x) in place of (1 - x)^2.
 * Valid: units to 1e-6 along each column; with leaves to 1e-2, up to an optical depth of 4 one way.
 * Units beyond a million are empty. The mean is that of a short pulse. A straight border anywhere
 * in a round uniform beam divides it to 0.095 at worst, 0.017 rms; a layer's top to 0.093 at worst,
 * 0.037 rms; one that crosses less than 0.013 of it is not seen. The sum of all shares that
 * surfaces take is exact, unit by unit. The transmitter is a point. Paths over two reflections meet
 * other leaves on each of their three ways.
 * Test: TestAir.cxx, TestBeamAir.cxx, TestWeather.py.
 */
#ifndef avianlidar_BeamAir_h
#define avianlidar_BeamAir_h

#include "Air.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace avianlidar
{
/// A sample of a surface that takes of the light.
struct MetSurface
{
  double range;          ///< m
  double weight;         ///< share of the pulse
  std::uint64_t columns; ///< bits of the grid's cells; 0: all
};

/// The leaf at which a ray of the beam ends.
struct MetLeaf
{
  std::uint32_t medium; ///< see BeamAir::mediumAt()
  double range;         ///< m
  double cosine;        ///< at which it is seen
};

/// Follows one beam after the other. One per thread; copies share the table of units.
class BeamAir
{
public:
  BeamAir(const Sensor& sensor, Air air);

  /// A part of the beam.
  struct Column
  {
    double x, y;        ///< in the beam's plane
    double weight;      ///< share of the pulse
    std::uint64_t bits; ///< cells of the grid, one bit each
    // The point of the aperture to which light returns; those of neighbours lie far apart.
    std::array<double, 2> towards{}; ///< unit vector from the middle of the aperture
    double nearer = 0.0;             ///< share of the aperture's area that is nearer to the middle
    double open = 1.0;               ///< share of its light that no surface has met so far
    std::size_t firstPart = 0;
    std::size_t lastPart = 0; ///< one past it
  };

  /// Begin a beam that no surface weakens. @param seconds when it is sent
  void begin(const BeamFrame& frame, double seconds);

  /// Begin a beam that meets no volume.
  void beginOutside();

  /// Begin with one direction alone. @param direction unit vector
  void beginRay(const Vec3& origin, const Vec3& direction, double seconds);

  /// Whether media that fill the scene send light back.
  bool fillsScene() const { return !this->Means->empty(); }

  /// Units in which these send light back, from 0 on.
  std::int64_t units() const { return static_cast<std::int64_t>(this->Means->size()); }

  /// Set the number of units, from 0 on, in which these may be perceived by themselves.
  void lookAt(std::int64_t units) { this->LookedEverywhere = units; }
  std::int64_t looked() const { return this->LookedEverywhere; }

  /// Whether the beam meets a volume.
  bool isLocal() const { return !this->Parts.empty(); }

  /// Whether what media return may be perceived by itself.
  bool returnsLight() const { return !this->Looked.empty(); }

  /// What volumes leave of the light on the way to a range and back. @param columns bits, 0: all
  double transmission(double range, std::uint64_t columns = 0) const;

  /// The same along a line, on the way from one point to another, m from the apex.
  double transmissionBetween(const Vec3& from, const Vec3& to);

  /// Take off what surfaces meet.
  void take(std::vector<MetSurface> surfaces);

  /// The surfaces of this beam, by range.
  const std::vector<MetSurface>& surfaces() const { return this->Surfaces; }

  /// What one medium sends back in a unit.
  struct Share
  {
    std::uint32_t medium; ///< see mediumAt()
    double mean;          ///< J
    double drops;         ///< on average
  };
  /// In an order that does not depend on earlier calls.
  const std::vector<Share>& sharesOf(std::int64_t unit);
  const Medium& mediumAt(std::uint32_t number) const { return this->All->media[number].medium; }

  /// Mean energy, J, in a unit that a threshold may follow.
  double followed(std::int64_t unit);

  /// The first unit from `unit` on in which media may be perceived by themselves; no such: the
  /// greatest number.
  std::int64_t nextLooked(std::int64_t unit) const;

  /// A medium of leaves, and the ranges, m, between which the beam may meet it.
  struct Leaves
  {
    std::uint32_t medium; ///< see mediumAt()
    double begin, end;
  };
  /// Find them, in the order of their beginnings.
  void findLeaves(std::vector<Leaves>& all) const;

  /// Half widths of the beam at 1 m, and radius of the aperture, m.
  std::array<double, 2> halfWidths() const { return this->HalfWidths; }
  double apertureRadius() const { return this->ApertureRadius; }

  /// Share of the light that leaves let through to a range, m, and back, on average.
  double leftByLeaves(double range) const;

  /// The cells of the grid, whether or not the beam is divided.
  const std::vector<Column>& grid();

  /// The column in which a cell lies; it stays until the next beam.
  const Column& columnOf(const Column& cell) const;

  /// Density of a medium in a column, over that of the medium.
  double densityAt(const Column& column, std::uint32_t medium, double range) const;

  /// Energy, J, that a leaf returns of a share of the pulse, if no leaf stops it on its way back.
  /// Surfaces take what they meet before the unit of the last sharesOf().
  double returnedBy(const MetLeaf& leaf, const Column& column, double share) const;

  /// Cells of the grid across the beam.
  static constexpr int Across = 8;
  /// The bit of a point of the beam's plane.
  static std::uint64_t columnAt(double x, double y)
  {
    const auto cell = [](double v)
    { return std::clamp(static_cast<int>(0.5 * Across * (v + 1.0)), 0, Across - 1); };
    return std::uint64_t{ 1 } << (Across * cell(y) + cell(x));
  }

  /// The bits of a square of so much to each side.
  static std::uint64_t columnsIn(double x, double y, double half)
  {
    constexpr double step = 2.0 / Across;
    std::uint64_t columns = 0;
    for (double v = y - half; v < y + half + step; v += step)
    {
      for (double u = x - half; u < x + half + step; u += step)
      {
        columns |= columnAt(std::min(u, x + half), std::min(v, y + half));
      }
    }
    return columns;
  }

  static constexpr double MostUnits = 1e6;

private:
  /// A piece of a column in a volume.
  struct Part
  {
    std::size_t seen; ///< its medium's place in Seen
    MediumCrossing crossing;
    double extinction; ///< there and back, 1/m; of leaves, there
    double perLeaf;    ///< inverse diameter of a leaf, 1/m; 0: none
  };
  struct PartRange
  {
    const Part *first, *last;
    const Part* begin() const { return this->first; }
    const Part* end() const { return this->last; }
  };
  PartRange partsOf(const Column& column) const
  {
    return { this->Parts.data() + column.firstPart, this->Parts.data() + column.lastPart };
  }
  const Medium& mediumOf(const Part& part) const { return this->mediumAt(this->Seen[part.seen]); }
  void makeMeans();
  void makeGrid();
  void divide(const BeamFrame& frame);
  bool rimAgrees() const;
  void mergeRows(const BeamFrame& frame, const Vec3& up);
  void findParts(const BeamFrame& frame);
  void findParts(Column& column, const Vec3& origin, const Vec3& direction);
  void findLooked();
  template <class F>
  double sumOver(const Column& column, F of) const;
  double depth(const Column& column, double range) const;
  double wayBack(const Column& column, double range) const;
  double gathered(double range) const;
  void takeUpTo(double range);
  void takeOne(const MetSurface& surface);
  void addColumn(const Column& column, double from, double to);
  void addPiece(const Column& column, double before, double from, double to);

  Sensor Instrument;
  std::shared_ptr<const Air> All;
  double Attenuation; ///< attenuation coefficient of all that fills the scene, 1/m
  double UnitLength;  ///< m
  double SolidAngle;  ///< sr
  std::int64_t Gate;  ///< units
  std::int64_t Reach; ///< units that pulses of drops reach beyond their own
  std::array<double, 2> HalfWidths;
  double ApertureRadius;                            ///< m
  std::vector<std::uint32_t> Filling;               ///< media that fill the scene
  double Backscatter = 0.0;                         ///< backscatter of `Filling`, 1/(m sr)
  std::shared_ptr<const std::vector<double>> Means; ///< energies that `Filling` returns, by unit, J
  std::int64_t LookedEverywhere = 0;
  std::vector<Column> Grid; ///< empty until a beam needs it

  // The beam.
  Vec3 Origin{ 0.0 };
  double Seconds = 0.0;
  std::vector<std::uint32_t> Seen; ///< media that fill the scene, and those it may meet
  std::vector<Column> Columns;
  std::vector<Part> Parts; ///< column by column
  /// Units in which media may be perceived, from and to, before those that no light reaches.
  std::vector<std::pair<std::int64_t, std::int64_t>> Looked;
  std::int64_t Dark = 0;   ///< from here on no light that matters is left
  double MostOfUnit = 0.0; ///< J per gathered sr: more than media return in a unit
  std::vector<MetSurface> Surfaces;
  std::size_t Taken = 0;  ///< number of `Surfaces` that took their share
  double TakenTo = 0.0;   ///< m
  double Left = 1.0;      ///< share of the pulse that is left
  std::int64_t Unit = -1; ///< unit to which `Shares` belong
  std::vector<Share> Shares;
  std::vector<double> Breaks;
  std::vector<Part> Here;        ///< parts of a column between two breaks
  std::vector<Share> Sums;       ///< by Seen
  std::array<double, 3> Known{}; ///< ends, m, and decay, 1/m, of the last piece of steady densities
  double OfKnown = 0.0;          ///< its integral, as if it began the beam
  std::vector<MediumCrossing> Found;
  MediumCrosser Crosser;
};
}

#endif
