// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarColourPreset_h
#define AvianLidarColourPreset_h

/**
 * Makes the colour preset "Avian lidar HSB" known to this process, unless a preset of that name is
 * there already (a user may have changed it). Called when the plugin is loaded. ParaView keeps it
 * among the user's own presets.
 */
void AvianLidarAddColourPreset();

#endif
