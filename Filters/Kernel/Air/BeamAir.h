// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamAir.h
 * @brief The air along one beam: the parts of the beam that lie in volumes, and what these parts
 * let through.
 *
 * The axis represents a beam if all volumes are wider than the beam, and if the rim crosses the
 * volumes at the same ranges and with the same optical depth as the axis. Otherwise the beam is
 * divided into columns. A column has a direction, a share of the pulse, and parts that lie in
 * volumes (MediumVolume.h). Columns are the cells of the grid (ScanAir.h), or eight rows if all
 * volumes are layers. Samples hold the columns of their rays (BeamSamples::columns). So a tree in
 * one half of a beam weakens only this half.
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
 * Source: the hot spot of leaves: A. Kuusk, Soviet Journal of Remote Sensing 3, 1985 (second-hand).
 * Differs: the paper's air fills the scene. Kuusk has exp(-x) in place of (1 - x)^2.
 * Valid: with leaves, the relative error of a transmission is at most 1e-2 up to an optical depth
 * of 4 one way. If a straight border divides a round uniform beam, the share of the pulse on one
 * side errs by 0.095 at worst and 0.017 rms. At the top of a layer, the share below the top errs by
 * 0.093 at worst and 0.037 rms. A border that cuts off less than 0.013 of the beam is ignored. The
 * transmitter is a point. Paths with two reflections meet different leaves on each of their three
 * ways.
 * Test: TestAir.cxx, TestBeamAir.cxx, TestWeather.py.
 */
#ifndef avianlidar_BeamAir_h
#define avianlidar_BeamAir_h

#include "ScanAir.h"

#include <array>
#include <cstddef>
#include <cstdint>
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

/// The air along one beam, found by AirFinder.h. The ScanAir must outlive the object.
class BeamAir
{
public:
  /// A beam that meets no volume.
  explicit BeamAir(const ScanAir& scan)
    : Scan(&scan)
  {
  }

  const ScanAir& scan() const { return *this->Scan; }
  const Medium& mediumAt(std::uint32_t number) const { return this->Scan->mediumAt(number); }

  /// True if the beam meets a volume.
  bool isLocal() const { return !this->Parts.empty(); }

  /// Columns of the beam; one column in a beam that is not divided.
  const std::vector<AirColumn>& columns() const
  {
    return this->isLocal() ? this->Columns : this->Scan->whole();
  }
  /// A column that contains one of some cells. @param bits bits of the cells; 0: all cells
  const AirColumn& columnOf(std::uint64_t bits) const;
  /// Number of a column in columns().
  std::size_t numberOf(const AirColumn& column) const
  {
    return static_cast<std::size_t>(&column - this->columns().data());
  }

  /// A part of a column that lies in one volume.
  struct Part
  {
    std::size_t seen; ///< place of the part's medium in the list of mediaMet()
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
  PartRange partsOf(const AirColumn& column) const
  {
    return { this->Parts.data() + column.firstPart, this->Parts.data() + column.lastPart };
  }

  /// The media that return light in the beam: first the media that fill the scene, then the media
  /// of volumes that the beam may meet.
  std::size_t mediaMet() const
  {
    return this->Scan->filling().size() + (this->isLocal() ? this->Volumes.size() : 0);
  }
  /// Number of such a medium for mediumAt().
  std::uint32_t mediumMet(std::size_t seen) const
  {
    const std::vector<std::uint32_t>& filling = this->Scan->filling();
    return seen < filling.size() ? filling[seen] : this->Volumes[seen - filling.size()];
  }

  /// Range units [first, end) in which volumes may be perceived without light from surfaces: units
  /// that overlap a part of a medium of drops or leaves, or of any medium if no threshold follows
  /// the air.
  const std::vector<std::pair<std::int64_t, std::int64_t>>& alone() const { return this->Alone; }

  /// Optical depth of volumes to a range, m, and back. Leaves count on the way there only.
  double depth(const AirColumn& column, double range) const;
  /// Transmission of leaves on the way back, for light that they transmitted on the way there.
  double wayBack(const AirColumn& column, double range) const;
  /// Transmission of volumes to a range, m, and back. @param columns bits of cells; 0: all cells
  double transmission(double range, std::uint64_t columns = 0) const;
  /// Transmission of volumes one way between two points. @param from, to points relative to the
  /// apex, m @param crosser, found memory
  double transmissionBetween(const Vec3& from, const Vec3& to, MediumCrosser& crosser,
    std::vector<MediumCrossing>& found) const;

  /// A medium of leaves, and the ranges between which the beam may meet it.
  struct Leaves
  {
    std::uint32_t medium; ///< number of the medium for mediumAt()
    double begin, end;    ///< ranges, m
  };
  /// All media whose leaves have a known size, in the order in which the beam first meets them.
  std::vector<Leaves> leaves() const;

  /// Mean transmission, to a range, m, and back, of leaves whose size is known: of a column, or of
  /// the beam.
  double leftByLeaves(const AirColumn& column, double range) const;
  double leftByLeaves(double range) const;

  /// Relative density of a medium in a column at a range, m; 1 where the medium has its full
  /// density.
  double densityAt(const AirColumn& column, std::uint32_t medium, double range) const;

  /// Surfaces that take shares of the pulse, by range, as AirLight needs them. In a beam that meets
  /// no volume, all surfaces between the middles of two consecutive units are merged.
  std::vector<MetSurface> arrange(std::vector<MetSurface> surfaces) const;

private:
  friend class AirFinder;

  template <class F>
  double sumOver(const AirColumn& column, F of) const;

  const ScanAir* Scan;
  Vec3 Origin{ 0.0 };
  double Seconds = 0.0;               ///< time at which the pulse is sent, s
  std::vector<std::uint32_t> Volumes; ///< media of volumes that the beam may meet
  std::vector<AirColumn> Columns;
  std::vector<Part> Parts; ///< column by column
  std::vector<std::pair<std::int64_t, std::int64_t>> Alone;
};
}

#endif
