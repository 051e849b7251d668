// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarBeamsDomain_h
#define AvianLidarBeamsDomain_h

/**
 * Called when the plugin is loaded: the plugin's XML may then use the domain AvianLidarBeamsDomain.
 * It holds outputs with the field data of an avian lidar (attribute field_array) and with the point
 * array of its beams that the input is for (attribute point_array). A mesh with normals has
 * neither.
 */
void AvianLidarAddDomains();

#endif
