// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamEchoes.h
 * @brief Third stage of a beam: makes returns, with standard errors and labels.
 *
 * The labels of a return are computed from all paths with a share in the return. The labels are the
 * object and material with the most energy, the mean angle of incidence, and the share of the
 * energy from paths with two reflections.
 *
 * Source: paper, Eq. 10-12.
 * Differs: the paper gives one point per perceived range unit, without labels. Returns are defined
 * in Receiver.h.
 * Valid: a false alarm has no object, no material and no angle. The standard error is NaN where
 * StandardError.h gives no error. For an integrated beam the standard error includes the bound of
 * PolygonQuadrature.h.
 * Test: TestScanReport.cxx, TestScan.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_BeamEchoes_h
#define avianlidar_BeamEchoes_h

#include "BeamLighting.h"
#include "EnergyErrors.h"
#include "LitBeam.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

namespace avianlidar
{
/// Energies of a return by object and material. A list is faster than a map, because a beam meets
/// few pairs of object and material. Most rays meet the same pair as the ray before. A LabelSums is
/// reused without allocation. Each thread needs its own object.
class LabelSums
{
public:
  void clear()
  {
    this->Sums.clear();
    this->Last = 0;
  }

  void add(int object, int material, double energy)
  {
    if (this->Sums.empty() || !this->Sums[this->Last].is(object, material))
    {
      this->Last = std::find_if(this->Sums.begin(), this->Sums.end(),
                     [=](const Sum& sum) { return sum.is(object, material); }) -
        this->Sums.begin();
      if (this->Last == this->Sums.size())
      {
        this->Sums.push_back({ object, material, 0.0 });
      }
    }
    this->Sums[this->Last].energy += energy;
  }

  struct Sum
  {
    int object;
    int material;
    double energy;
    bool is(int o, int m) const { return this->object == o && this->material == m; }
  };

  /// The largest sum. If sums are equal, the lowest object id is taken, then the lowest material
  /// id.
  const Sum& largest() const
  {
    return *std::min_element(this->Sums.begin(), this->Sums.end(),
      [](const Sum& a, const Sum& b)
      {
        return std::make_tuple(-a.energy, a.object, a.material) <
          std::make_tuple(-b.energy, b.object, b.material);
      });
  }

  /// Sum of all energies, J.
  double total() const
  {
    double sum = 0.0;
    for (const Sum& s : this->Sums)
    {
      sum += s.energy;
    }
    return sum;
  }

private:
  std::vector<Sum> Sums;
  std::size_t Last = 0;
};

/// Finds the labels of echoes. An EchoLabels is reused without allocation. Each thread needs its
/// own object.
class EchoLabels
{
public:
  /// The setup must outlive the object.
  explicit EchoLabels(const ScanSetup& setup)
    : Setup(setup)
  {
  }

  /// Set the labels of an echo. @param samples samples of the beam, or null @param paths paths with
  /// two reflections, whose contributions are numbered after the contributions of the samples
  void label(const RangeShares& shares, const BeamSamples* samples,
    const std::vector<SecondaryPath>& paths, Echo& echo);

private:
  void findAngles(
    const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths);
  bool meetsOneThing(const BeamSamples& samples, const std::vector<SecondaryPath>& paths) const;
  void findLargest(
    const RangeShares& shares, const BeamSamples& samples, const std::vector<SecondaryPath>& paths);

  const ScanSetup& Setup;
  LabelSums Sums;
  std::vector<double> Angles; ///< angles of incidence of the shares, rad
};

/// Receives one beam after the other. Each thread needs its own object. The constructor's arguments
/// must outlive the object.
class BeamEchoes
{
public:
  BeamEchoes(const ScanSetup& setup, BeamLighting& lighting, BeamReceiver& receiver,
    StandardErrorEstimator& ofRays);

  /// Append the echoes of the beam lit last. @param keep output: those values of the returns that
  /// do not depend on noise; may be null @param report output: status and range
  void receive(std::uint64_t beam, LitBeam* keep, std::vector<Echo>& echoes, BeamReport& report);

  /// Append the echoes of a beam lit in an earlier scan. @param report output: status, range, lost
  /// and skipped @return false, with echoes and report unchanged, if `known` lacks a return
  bool receiveAgain(
    std::uint64_t beam, const LitBeam& known, std::vector<Echo>& echoes, BeamReport& report);

private:
  template <class F>
  void finish(
    F echoOf, bool outsideGate, bool meets, std::vector<Echo>& echoes, BeamReport& report);
  Echo echoOfLight(const Return& ret);
  void addLeaves(const Return& ret, Echo& echo) const;
  LitBeam::KnownReturn unitsOf(const Return& ret) const;
  const LitBeam::KnownReturn* find(const LitBeam& known, const Return& ret) const;

  const ScanSetup& Setup;
  BeamLighting& Lighting;
  BeamReceiver& Receiver;
  EchoLabels Labels;
  EnergyErrors Errors;
};
}

#endif
