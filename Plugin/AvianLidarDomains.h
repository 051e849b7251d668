// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarDomains_h
#define AvianLidarDomains_h

/**
 * Called when the plugin is loaded: the plugin's XML may then use two domains. A proxy that a
 * client makes before it loads the plugin, of a server's XML, is without them; its beams are an
 * error where its two beamwidths differ.
 *
 * AvianLidarMaterialDomain is a DoubleRangeDomain of a coefficient of a material (attribute
 * coefficient: 0 kd, 1 ks, 2 kp). When the required property Material becomes a named one, the
 * panel shows its coefficient.
 *
 * AvianLidarScaledDomain is a DoubleRangeDomain of a value in another unit: it is that of the
 * required property Other times the attribute factor, whichever of the two is changed.
 */
void AvianLidarAddDomains();

#endif
