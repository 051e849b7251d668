// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarBirdTargets.h
 * @brief Makes targets of birds: the silhouettes of a species from all sides. All filters of a
 * process share the targets. Not installed.
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
  static Target TargetOf(const avianlidar::BirdSpecies& species, bool gliding, double area);

  /// The target without a species.
  Target Point{ "", 0.0,
    std::make_shared<const avianlidar::TargetViews>(
      avianlidar::viewsOf({ avianlidar::Silhouette() })) };
};

#endif
