// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DiscPolygon.h
 * @brief Part of a convex polygon inside the unit disc, in strips across a direction, with closed
 * forms for the moments of every strip.
 *
 * p is the coordinate along the direction, q the one across. Within a strip each end of the chords
 * is a side or an arc, so that its length is a + b p or follows sqrt(1 - p^2), whose moments are
 * elementary.
 *
 * Source: none.
 * Valid: moments of all strips together are right to 1e-15 of those of the disc.
 * Test: TestPolygonQuadrature.cxx.
 */
#ifndef avianlidar_DiscPolygon_h
#define avianlidar_DiscPolygon_h

#include "VisiblePolygons.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
/// Integrals over consecutive parts of the disc: of 1, p, p^2, q^2 and q^4, in SIMD lanes.
struct PartMoments
{
  std::vector<double> area, p, pp, qq, qqqq;
  /// Set the moments of so many parts to 0.
  void reset(std::size_t parts)
  {
    for (std::vector<double>* lane : { &this->area, &this->p, &this->pp, &this->qq, &this->qqqq })
    {
      lane->assign(parts, 0.0);
    }
  }
};

class DiscPolygon
{
public:
  /// An end of the chords of a strip.
  struct Bound
  {
    bool arc;
    double a, b; ///< q = a + b p; of an arc the sign of q is in `b`
    double at(double p) const;
  };
  struct Strip
  {
    double from, to; ///< p
    Bound upper, lower;
  };
  static constexpr int MostStrips = 3 * PlaneRing::MostCorners + 2;

  /// Set the polygon. @param along direction of p; need not be normalised; zero: any
  void set(const PlaneRing& ring, const PlanePoint& along);

  bool isEmpty() const { return this->Count == 0; }
  double least() const { return this->Strips[0].from; }
  double most() const { return this->Strips[this->Count - 1].to; }
  int count() const { return this->Count; }
  const Strip& strip(int k) const { return this->Strips[k]; }

  /// Moments of the parts between borders, ascending in p. @param borders one more than parts
  void measure(const std::vector<double>& borders, PartMoments& moments);

  /// The chord at p, which lies in one of the strips or between two.
  struct Chord
  {
    double low, high; ///< q
  };
  Chord chordAt(double p) const;

private:
  void addStrip(const Strip& strip, std::size_t first, std::size_t parts, PartMoments& moments);

  Strip Strips[MostStrips];
  int Count = 0;
  std::vector<double> Places; ///< borders of the parts in a strip
  std::vector<double> Arcs;   ///< primitives of powers of sqrt(1 - p^2) there
};

/// Area of a ring's part in the disc. Its corners may lie anywhere: the error is some 1e-16 of
/// their distance.
double areaInDisc(const PlaneRing& ring);
}

#endif
