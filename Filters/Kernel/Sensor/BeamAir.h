// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamAir.h
 * @brief The air along one beam: what it leaves of the light, and what it sends back in each range
 * unit, of which surfaces take their share.
 *
 * Where all air is the same everywhere, AirEcho.h knows the units, and only the share of the pulse
 * counts that no nearer surface has met. Of a beam that meets media which do not fill the scene its
 * axis counts, if they are wider than it and its rim crosses them where the axis does, and as deep.
 * Else it is divided into columns, each with a direction, a share of the pulse, and the parts in
 * which it crosses the media (MediumVolume.h): the cells of a grid of eight by eight over its
 * plane, or of layers alone, eight rows. A sample knows the columns that its rays lie in
 * (BeamSamples::columns). So light behind half a tree is weakened where the tree is, and a tree
 * behind half a wall returns what the wall leaves.
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
 * Source: the lidar equation, as AirEcho.h; the hot spot of leaves: A. Kuusk, Soviet Journal of
 * Remote Sensing 3, 1985 (second-hand).
 * Differs: as AirEcho.h. Kuusk has exp(-x) in place of (1 - x)^2.
 * Valid: units to 1e-6 along each column; with leaves to 1e-2, up to an optical depth of 4 one way.
 * A straight border anywhere in a round uniform beam divides it to 0.095 at worst, 0.017 rms; a
 * layer's top to 0.093 at worst, 0.037 rms; one that crosses less than 0.013 of it is not seen. The
 * sum of all shares that surfaces take is exact, unit by unit. The transmitter is a point. Paths
 * over two reflections meet other leaves on each of their three ways.
 * Test: TestBeamAir.cxx.
 */
#ifndef avianlidar_BeamAir_h
#define avianlidar_BeamAir_h

#include "AirEcho.h"
#include "BeamShape.h"
#include "MediumVolume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace avianlidar
{
/// The leaf at which a ray of the beam ends.
struct MetLeaf
{
  std::uint32_t medium; ///< see BeamAir::mediumAt()
  double range;         ///< m
  double cosine;        ///< at which it is seen
};

/// Surfaces that a beam meets, as its air needs them.
struct SurfacesInAir
{
  const double* ranges = nullptr;         ///< m
  const double* weights = nullptr;        ///< shares of the pulse
  const std::uint64_t* columns = nullptr; ///< bits; null: all
  std::size_t count = 0;
};

/// Follows one beam after the other. One per thread; media must outlive it.
class BeamAir
{
public:
  /// @param attenuation of all air that fills the scene, 1/m @param everywhere that of it which
  /// scatters @param placed other media @param looked units in which air that fills the scene may
  /// be perceived
  BeamAir(const Sensor& sensor, double attenuation, const std::vector<Medium>& everywhere,
    const std::vector<PlacedMedium>& placed,
    std::int64_t looked = std::numeric_limits<std::int64_t>::max());

  /// A part of the beam.
  struct Column
  {
    double x, y;        ///< in the beam's plane
    double weight;      ///< share of the pulse
    std::uint64_t bits; ///< cells of the grid, one bit each
    // The point of the aperture to which light returns; those of neighbours lie far apart.
    std::array<double, 2> towards{}; ///< unit vector from the middle of the aperture
    double nearer = 0.0;             ///< share of the aperture's area that is nearer to the middle
  };

  /// Begin a beam that no surface weakens. @param seconds when it is sent
  void begin(const BeamFrame& frame, double seconds);

  /// Begin a beam where all media fill the scene.
  void beginEverywhere()
  {
    this->Met.clear();
    this->Open.clear();
    this->Looked.clear();
  }

  /// Begin with one direction alone. @param direction unit vector
  void beginRay(const Vec3& origin, const Vec3& direction, double seconds);

  /// Whether it meets a medium that does not fill the scene.
  bool isLocal() const { return !this->Met.empty(); }

  /// Whether what it returns of these media may be perceived by itself.
  bool returnsLight() const { return !this->Looked.empty(); }

  /// What media that do not fill the scene leave of light on the way to a range and back.
  /// @param columns bits, 0: all
  double transmission(double range, std::uint64_t columns = 0);

  /// The same along a line, on the way from one point to another, m from the apex.
  double transmissionBetween(const Vec3& from, const Vec3& to);

  /// Take off what surfaces meet. They must live until the next beam.
  void take(const SurfacesInAir& surfaces);

  /// Shares of the pulse that no surface has met, from the unit of the first on; see setOpen().
  const std::vector<double>& open() const { return this->Open; }
  std::int64_t firstTaken() const { return this->FirstTaken; }
  void setOpen(std::int64_t first, std::vector<double> open);

  /// Share of the pulse that no surface has met by the middle of a unit.
  double open(std::int64_t unit) const;

  /// What one medium sends back in a unit.
  struct Share
  {
    std::uint32_t medium; ///< see mediumAt()
    double mean;          ///< J
    double drops;         ///< on average
  };
  /// Of a beam that isLocal(); in an order that does not depend on earlier calls.
  const std::vector<Share>& sharesOf(std::int64_t unit);
  const Medium& mediumAt(std::uint32_t number) const;

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

  /// The number of the column in which a cell lies.
  std::size_t columnOf(const Column& cell) const;

  /// Density of a medium in a column, over that of the medium.
  double densityAt(std::size_t column, std::uint32_t medium, double range) const;

  /// Energy, J, that a leaf returns of a share of the pulse, if no leaf stops it on its way back.
  /// Surfaces take what they meet before the unit of the last sharesOf().
  double returnedBy(const MetLeaf& leaf, std::size_t column, double share) const;

  /// Mean energy, J, in a unit that a threshold may follow. @param echo of the air that fills the
  /// scene
  double followed(const AirEcho& echo, std::int64_t unit);

  /// The first unit from `unit` on in which media may be perceived by themselves; no such: the
  /// greatest number.
  std::int64_t nextLooked(std::int64_t unit) const;

  /// Cells of the grid across the beam.
  static constexpr int Across = 8;
  /// The bit of a point of the beam's plane.
  static std::uint64_t columnAt(double x, double y)
  {
    const auto cell = [](double v)
    {
      const int k = static_cast<int>(0.5 * Across * (v + 1.0));
      return k < 0 ? 0 : k < Across ? k : Across - 1;
    };
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

private:
  struct Part
  {
    std::uint32_t medium;
    std::uint32_t met; ///< its place in Met
    MediumCrossing crossing;
    double perLeaf; ///< inverse diameter of a leaf, 1/m
  };
  using Steady = std::array<double, 3>; ///< from and to, m, and the slope of the depth, 1/m
  bool rimAgrees(const BeamFrame& frame);
  void chooseColumns(const BeamFrame& frame);
  void findParts(const Vec3& origin, const Vec3& direction);
  double depth(std::size_t column, double range) const;
  double wayBack(std::size_t column, double range) const;
  void makeGrid();
  void takeUpTo(double range);
  void takeOne(double weight, std::uint64_t columns);
  const Medium& mediumOf(const Part& part) const { return this->Placed[part.medium].medium; }
  double waysOf(const Part& part) const { return this->mediumOf(part).sharesGaps ? 1.0 : 2.0; }
  double gathered(double range) const;
  void addShares(std::size_t column, double open, double from, double to);
  double weightOf(std::uint64_t columns) const;
  void chooseLooked();

  Sensor Instrument;
  double Attenuation; ///< 1/m
  double UnitLength;  ///< m
  double SolidAngle;  ///< sr
  const std::vector<Medium>& Everywhere;
  const std::vector<PlacedMedium>& Placed;
  std::int64_t LookedEverywhere;
  std::array<double, 2> HalfWidths;
  double ApertureRadius;    ///< m
  std::vector<Column> Grid; ///< empty until a beam needs it
  Column Axis{ 0.0, 0.0, 1.0, ~std::uint64_t{ 0 } };

  // The beam.
  Vec3 Origin{ 0.0 };
  double Seconds = 0.0;
  std::vector<Column> Columns;
  std::vector<std::uint32_t> Met; ///< media that do not fill the scene
  std::vector<Part> Parts;        ///< column by column
  std::vector<Part> Here;         ///< of a piece of a column
  std::vector<std::size_t> Ends;  ///< of the parts of each
  /// Units in which media may be perceived, from and to, in order.
  std::vector<std::pair<std::int64_t, std::int64_t>> Looked;
  std::int64_t FirstTaken = 0;
  std::vector<double> Open; ///< by unit, from FirstTaken on
  SurfacesInAir Surfaces;
  std::vector<std::uint32_t> Order; ///< of surfaces, by range
  std::size_t Taken = 0;            ///< of these
  double TakenTo = 0.0;             ///< m
  double Left = 1.0;                ///< of the pulse
  std::vector<double> OpenOf;       ///< share of each column
  std::int64_t Unit = -1;           ///< of Shares
  std::vector<Share> Shares;
  Steady Known{ 0.0, 0.0, 0.0 }; ///< the last piece without a change of density
  double OfKnown = 0.0;          ///< its integral, as if it began the beam
  std::vector<double> Breaks;
  std::vector<double> Means, Drops; ///< of those that fill the scene, and of those met
  std::vector<MediumCrossing> Found;
  MediumCrosser Crosser;
};
}

#endif
