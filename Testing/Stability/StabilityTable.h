// SPDX-License-Identifier: BSD-3-Clause
// Rows of the table of extremes: each is checked where it is made, and written down on request.
#ifndef StabilityTable_h
#define StabilityTable_h

#include <string>

namespace stability
{
/// A promise over a range of input, and the worst case met.
struct Row
{
  std::string extreme; ///< what is extreme
  std::string range;   ///< range of the input that was tried
  /// How beams were looked into: "rays" alone, "default" (polygons and cells), "both", "paper" (the
  /// preset), or "-" where no beam is.
  std::string view;
  std::string promise; ///< what `worst` measures, and against which oracle
  double bar;          ///< `worst` may be at most this
  double worst;
};

/// Fails the test unless worst <= bar (NaN fails). If the environment variable
/// AVIANLIDAR_STABILITY_ROWS names a file, the row is appended to it, its members separated by
/// tabs.
void record(const Row& row);

/// Keeps the largest of what it is given; NaN counts as infinity.
class Worst
{
public:
  void see(double value)
  {
    this->Largest = value <= this->Largest ? this->Largest : (value == value ? value : Infinite());
  }
  double value() const { return this->Largest; }

private:
  static double Infinite() { return 1.0 / 0.0; }
  double Largest = 0.0;
};
}

#endif
