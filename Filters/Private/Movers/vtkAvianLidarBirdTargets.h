// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBirdTargets.h
 * @brief Makes targets of birds: the silhouettes of a species from all sides. Not installed.
 */
#ifndef vtkAvianLidarBirdTargets_h
#define vtkAvianLidarBirdTargets_h

#include "Bird.h"
#include "DetectionLaw.h"

#include <memory>
#include <string>
#include <vector>

class vtkAvianLidarBirdTargets
{
public:
  struct Target
  {
    std::string Name; ///< name of the species; empty without a species
    double Area;      ///< mean effective area, m^2
    std::shared_ptr<const avianlidar::TargetViews> Views;
  };

  /// The chosen targets, first the target of `species`. Throws std::runtime_error, which names the
  /// property. @param species name of the species; empty: a target with the effective area `area`
  /// from all sides @param area mean effective area, m^2; 0: the area of the species @param all
  /// true if all other species follow
  std::vector<Target> Choose(const std::string& species, const std::string& speciesFileName,
    bool gliding, double area, bool all);

private:
  /// A species with its targets, which are kept from one execution to the next.
  struct Bird
  {
    avianlidar::BirdSpecies Species;
    bool Gliding;
    double MeanArea; ///< mean area of the species, m^2
    std::vector<Target> Sizes;
  };
  const Target& TargetOf(const avianlidar::BirdSpecies& species, bool gliding, double area);

  std::vector<Bird> Known;
  /// The target without a species.
  Target Point{ "", 0.0,
    std::make_shared<const avianlidar::TargetViews>(
      avianlidar::viewsOf({ avianlidar::Silhouette() })) };
};

#endif
