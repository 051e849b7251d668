// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBirdTargets.h
 * @brief Birds as targets of a lidar: what they show of themselves from all sides. Not installed.
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
    std::string Name; ///< empty without a species
    double Area;      ///< mean effective area, m^2
    std::shared_ptr<const avianlidar::TargetViews> Views;
  };

  /// The targets that are wanted, the one shown first. Throws std::runtime_error that names the
  /// property. @param species empty: one that always shows `area` @param area m^2; 0: that of the
  /// species @param all whether all others that are known follow
  std::vector<Target> Choose(const std::string& species, const std::string& speciesFileName,
    bool gliding, double area, bool all);

private:
  /// Kept from execution to execution.
  struct Bird
  {
    avianlidar::BirdSpecies Species;
    bool Gliding;
    double MeanArea; ///< mean area of the species, m^2
    std::vector<Target> Sizes;
  };
  const Target& TargetOf(const avianlidar::BirdSpecies& species, bool gliding, double area);

  std::vector<Bird> Known;
  /// Without a species.
  Target Point{ "", 0.0,
    std::make_shared<const avianlidar::TargetViews>(
      avianlidar::viewsOf({ avianlidar::Silhouette() })) };
};

#endif
