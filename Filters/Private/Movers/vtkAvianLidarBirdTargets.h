// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBirdTargets.h
 * @brief Birds as targets of a lidar: their effective areas by pose. Not installed.
 */
#ifndef vtkAvianLidarBirdTargets_h
#define vtkAvianLidarBirdTargets_h

#include "Bird.h"
#include "EffectiveArea.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

class vtkAvianLidarBirdTargets
{
public:
  struct Target
  {
    std::string Name; ///< empty without a species
    double Area;      ///< mean effective area, m^2
    std::vector<avianlidar::TargetPose> Poses;
  };

  /// The targets that are wanted, the one shown first. Throws std::runtime_error that names the
  /// property. @param species empty: one that always shows `area` @param area m^2; 0: that of the
  /// species @param all whether all others that are known follow
  std::vector<Target> Choose(const std::string& species, const std::string& speciesFileName,
    bool gliding, double area, bool all);

private:
  const avianlidar::BirdAreas& AreasOf(const avianlidar::BirdSpecies& species, bool gliding);

  /// What was found so far, for flapping and gliding birds.
  std::map<std::string, std::pair<avianlidar::BirdSpecies, avianlidar::BirdAreas>> Known[2];
};

#endif
