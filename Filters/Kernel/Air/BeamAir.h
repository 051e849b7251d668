// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamAir.h
 * @brief The air along one beam: the transmission of the air, and the light that the air returns in
 * each range unit from the part of the pulse that no nearer surface has met.
 *
 * From the range R1 to R2 a medium returns E mu/S times the integral over R of O(R) min(A/R^2, 2
 * pi) exp(-depth(R)). E is the pulse energy, mu/S the backscatter (Air.h), A the aperture, O
 * Sensor::nearRangeShare(), and depth the optical depth of all air on the way to R and back. Media
 * that fill the scene have a table of these energies. Only the share of the pulse that no nearer
 * surface has met counts.
 *
 * The axis represents a beam if all volumes are wider than the beam, and if the rim crosses the
 * volumes at the same ranges and with the same optical depth as the axis. Otherwise the beam is
 * divided into columns. A column has a direction, a share of the pulse, and parts that lie in
 * volumes (MediumVolume.h). Columns are the cells of a grid of eight by eight over the beam's
 * plane, or eight rows if all volumes are layers. Samples hold the columns of their rays
 * (BeamSamples::columns). So a tree in one half of a beam weakens only this half. A tree that is
 * half hidden by a wall returns half of its light.
 *
 * Leaves stop light on the way out and on the way back. A leaf that would stop the light twice
 * counts once. Light from a range R returns to any point of the aperture, a disc about the apex. If
 * this point lies q from the apex, the two ways are q (1 - z/R) apart at a range z. The distance
 * between the two ways is x times the diameter of a leaf. A leaf of random orientation that stops
 * light on the way out also stops light on the way back with the probability (1 - x)^2, or 0 if x
 * exceeds 1. So leaves transmit exp(-mu int (2 - (1 - x)^2) dz) there and back, averaged over the
 * aperture. For a length L this transmission lies between exp(-2 mu L) and exp(-mu L). It is
 * exp(-mu L) if the aperture is much smaller than a leaf.
 *
 * A range unit that overlaps a part of a medium may be perceived without light from surfaces, if
 * the media return more than a millionth of the lower limit.
 *
 * Source: the lidar equation, single scattering, e.g. U. Wandinger, in: Lidar, Springer, 2005; the
 * hot spot of leaves: A. Kuusk, Soviet Journal of Remote Sensing 3, 1985 (second-hand).
 * Differs: the paper's air sends nothing back. Kuusk has exp(-x) in place of (1 - x)^2.
 * Valid: along each column the relative error of a unit's energy is at most 2e-6, and at most 1e-3
 * in unit 0. With leaves, the relative error is at most 1e-2 up to an optical depth of 4 one way.
 * The table ends at a million units. Mean energies hold for a short pulse. If a straight border
 * divides a round uniform beam, the share of the pulse on one side errs by 0.095 at worst and 0.017
 * rms. At the top of a layer, the share below the top errs by 0.093 at worst and 0.037 rms. A
 * border that cuts off less than 0.013 of the beam is ignored. The sum of all shares that surfaces
 * take is exact, unit by unit. The transmitter is a point. Paths with two reflections meet
 * different leaves on each of their three ways.
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
/// A sample of a surface that takes a share of the pulse.
struct MetSurface
{
  double range;          ///< range of the sample, m
  double weight;         ///< share of the pulse
  std::uint64_t columns; ///< bits of the grid's cells that the sample meets; 0: all cells
};

/// The leaf at which a ray of the beam ends.
struct MetLeaf
{
  std::uint32_t medium; ///< number of the medium for BeamAir::mediumAt()
  double range;         ///< range of the leaf, m
  double cosine;        ///< cosine of incidence, in [0, 1]
};

/// Follows the air along one beam at a time. Each thread needs its own object. Copies share the
/// table of energies.
class BeamAir
{
public:
  BeamAir(const Sensor& sensor, Air air);

  /// A part of the beam that has one direction.
  struct Column
  {
    double x, y;        ///< direction, as a point of the beam's plane
    double weight;      ///< share of the pulse
    std::uint64_t bits; ///< cells of the grid, one bit per cell
    // The point of the aperture to which light returns. Points of neighbouring columns lie far
    // apart.
    std::array<double, 2> towards{}; ///< unit vector from the aperture's middle to this point
    double nearer = 0.0;             ///< share of the aperture nearer to the middle than this point
    double open = 1.0;               ///< share of the column's light that no surface has met so far
    std::size_t firstPart = 0;
    std::size_t lastPart = 0; ///< one past the last part
  };

  /// Begin a beam without surfaces. @param seconds time at which the pulse is sent, s
  void begin(const BeamFrame& frame, double seconds);

  /// Begin a beam that meets no volume.
  void beginOutside();

  /// Begin a beam that has one direction. @param direction unit vector @param seconds time at which
  /// the pulse is sent, s
  void beginRay(const Vec3& origin, const Vec3& direction, double seconds);

  /// True if media that fill the scene return light.
  bool fillsScene() const { return !this->Means->empty(); }

  /// Number of units, from unit 0 on, in which media that fill the scene return light.
  std::int64_t units() const { return static_cast<std::int64_t>(this->Means->size()); }

  /// Set the number of units, from unit 0 on, in which media that fill the scene may be perceived
  /// without light from surfaces.
  void lookAt(std::int64_t units) { this->LookedEverywhere = units; }
  std::int64_t looked() const { return this->LookedEverywhere; }

  /// True if the beam meets a volume.
  bool isLocal() const { return !this->Parts.empty(); }

  /// True if media may be perceived without light from surfaces.
  bool returnsLight() const { return !this->Looked.empty(); }

  /// Transmission of volumes to a range, m, and back. @param columns bits of cells; 0: all cells
  double transmission(double range, std::uint64_t columns = 0) const;

  /// Transmission of volumes one way between two points. @param from, to points relative to the
  /// apex, m
  double transmissionBetween(const Vec3& from, const Vec3& to);

  /// Set the surfaces of this beam. Each surface takes its share of the pulse from the air behind
  /// the surface.
  void take(std::vector<MetSurface> surfaces);

  /// Surfaces of this beam, by range. In a beam that meets no volume, surfaces are merged unit by
  /// unit.
  const std::vector<MetSurface>& surfaces() const { return this->Surfaces; }

  /// Light that one medium returns in a unit.
  struct Share
  {
    std::uint32_t medium; ///< number of the medium for mediumAt()
    double mean;          ///< mean energy, J
    double drops;         ///< mean number of drops
  };
  /// Shares of the media in a unit, in an order that does not depend on earlier calls.
  const std::vector<Share>& sharesOf(std::int64_t unit);
  const Medium& mediumAt(std::uint32_t number) const { return this->All->media[number].medium; }

  /// Mean energy, J, that a unit receives from all media that a threshold may follow.
  double followed(std::int64_t unit);

  /// First unit, from `unit` on, in which media may be perceived without light from surfaces. The
  /// largest integer means that no such unit follows.
  std::int64_t nextLooked(std::int64_t unit) const;

  /// A medium of leaves, and the ranges between which the beam may meet it.
  struct Leaves
  {
    std::uint32_t medium; ///< number of the medium for mediumAt()
    double begin, end;    ///< ranges, m
  };
  /// Find all media whose leaves have a known size, in the order in which the beam first meets
  /// them.
  void findLeaves(std::vector<Leaves>& all) const;

  /// Half widths of the beam at a range of 1 m, and radius of the aperture, m.
  std::array<double, 2> halfWidths() const { return this->HalfWidths; }
  double apertureRadius() const { return this->ApertureRadius; }

  /// Mean transmission, to a range, m, and back, of leaves whose size is known: of a column, or of
  /// the beam.
  double leftByLeaves(const Column& column, double range) const;
  double leftByLeaves(double range) const;

  /// Cells of the grid that lie in the beam, whether or not the beam is divided.
  const std::vector<Column>& grid();

  /// A column that contains one of some cells; valid until the next beam begins. @param bits bits
  /// of the cells; 0: all cells
  const Column& columnOf(std::uint64_t bits) const;

  /// Relative density of a medium in a column at a range, m; 1 where the medium has its full
  /// density.
  double densityAt(const Column& column, std::uint32_t medium, double range) const;

  /// Energy, J, that a leaf returns from a share of the pulse, if no leaf stops this light on the
  /// way back. Surfaces nearer than the middle of the unit last given to sharesOf() have taken
  /// their shares.
  double returnedBy(const MetLeaf& leaf, const Column& column, double share) const;

  /// Number of cells across the beam, along each axis.
  static constexpr int Across = 8;
  /// Bit of the cell that holds a point of the beam's plane.
  static std::uint64_t columnAt(double x, double y)
  {
    const auto cell = [](double v)
    { return std::clamp(static_cast<int>(0.5 * Across * (v + 1.0)), 0, Across - 1); };
    return std::uint64_t{ 1 } << (Across * cell(y) + cell(x));
  }

  /// Bits of the cells that a square about (x, y) meets. @param half half the side of the square
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

  static constexpr double MostUnits = 1e6; ///< largest number of units in the table

private:
  /// A part of a column that lies in one volume.
  struct Part
  {
    std::size_t seen; ///< index of the part's medium in `Seen`
    MediumCrossing crossing;
    double extinction; ///< extinction on both ways, 1/m; for leaves only on the way out
    double perLeaf;    ///< inverse diameter of a leaf, 1/m; 0: no leaves, or leaves of unknown size
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
  double collected(double range) const;
  void takeUpTo(double range);
  void takeOne(const MetSurface& surface);
  void addColumn(const Column& column, double from, double to);
  void addPiece(const Column& column, double before, double from, double to);

  Sensor Instrument;
  std::shared_ptr<const Air> All;
  double Attenuation; ///< attenuation coefficient of all air that fills the scene, 1/m
  double UnitLength;  ///< length of a range unit, m
  double SolidAngle;  ///< solid angle of the beam, sr
  std::int64_t Gate;  ///< number of units inside the gate
  std::int64_t Reach; ///< number of units that a drop's pulse reaches on each side of its own unit
  std::array<double, 2> HalfWidths;
  double ApertureRadius;                            ///< radius of the aperture, m
  std::vector<std::uint32_t> Filling;               ///< media that fill the scene and return light
  double Backscatter = 0.0;                         ///< backscatter of `Filling`, 1/(m sr)
  std::shared_ptr<const std::vector<double>> Means; ///< energies that `Filling` returns, by unit, J
  std::int64_t LookedEverywhere = 0;
  std::vector<Column> Grid; ///< cells in the beam; empty until a beam needs them

  // State of the current beam.
  Vec3 Origin{ 0.0 };
  double Seconds = 0.0;
  std::vector<std::uint32_t> Seen; ///< `Filling`, then media of volumes that the beam may meet
  std::vector<Column> Columns;
  std::vector<Part> Parts; ///< column by column
  /// Units [first, end) in which media may be perceived without light from surfaces.
  std::vector<std::pair<std::int64_t, std::int64_t>> Looked;
  std::int64_t Dark = 0;   ///< unit at which and beyond which media return no light that matters
  double MostOfUnit = 0.0; ///< bound of a unit's energy from media, J per sr of collected()
  std::vector<MetSurface> Surfaces;
  std::size_t Taken = 0;  ///< number of `Surfaces` that have taken their shares
  double TakenTo = 0.0;   ///< range before which surfaces have taken their shares, m
  double Left = 1.0;      ///< share of the pulse that no surface has met so far
  std::int64_t Unit = -1; ///< unit to which `Shares` belong
  std::vector<Share> Shares;
  std::vector<double> Breaks;    ///< borders of parts in a unit, m; in take(): weights
  std::vector<Part> Here;        ///< parts of a column between two `Breaks`
  std::vector<Share> Sums;       ///< shares of a unit, in the order of `Seen`
  std::array<double, 3> Known{}; ///< ends, m, and decay, 1/m, of the last piece of constant density
  double OfKnown = 0.0;          ///< integral of `Known`'s piece without extinction before it, m sr
  std::vector<MediumCrossing> Found;
  MediumCrosser Crosser;
};
}

#endif
