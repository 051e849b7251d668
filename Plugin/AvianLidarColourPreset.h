// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarColourPreset_h
#define AvianLidarColourPreset_h

/**
 * Makes the colour presets "Avian lidar HSB" (energy), "Avian lidar status" (what became of each
 * beam, with words) and "Avian lidar coverage status" (why a bird is seen somewhere or not, with
 * words) known to this process, unless a preset of that name is there already (a user may have
 * changed it). Called when the plugin is loaded. ParaView keeps them among the user's own presets.
 */
void AvianLidarAddColourPresets();

#endif
