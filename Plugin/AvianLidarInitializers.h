// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarInitializers_h
#define AvianLidarInitializers_h

// What ParaView calls when it loads the plugin.

/**
 * Makes the colour presets (Presets/) known to this process, unless a preset of that name is there
 * already (a user may have changed it). ParaView keeps them among the user's own presets.
 */
void AvianLidarAddColourPresets();

/**
 * The plugin's XML may then use three domains. A proxy that a client makes before it loads the
 * plugin, of a server's XML, is without them; its beams are an error where its two beamwidths
 * differ.
 *
 * AvianLidarBeamsDomain accepts the beams of a sensor.
 *
 * AvianLidarMaterialDomain is a DoubleRangeDomain of a coefficient of a material (attribute
 * coefficient, as for vtkAvianLidarMaterial::GetCoefficientName()). When the required property
 * Material becomes a named one, the panel shows its coefficient.
 *
 * AvianLidarScaledDomain is a DoubleRangeDomain of a value in another unit: it is that of the
 * required property Other times the attribute factor, whichever of the two is changed.
 */
void AvianLidarAddDomains();

/**
 * ParaView's window gets the toolbar Avian Lidar, at once or as soon as there is a window. It has
 * the macros that are installed beside the plugin, which the menu Macros and, in ParaView 5.11, the
 * quick launch (Ctrl+Space) have, too, and the echo filter. A click on a macro is one step of Edit
 * > Undo. Filters whose XML has the hint AvianLidarMenu are in menus and quick launch by its text:
 * ParaView searches these texts alone, and the label is the name in Python. The first Apply gives
 * echoes the colours of the macro and a range image its view. ParaView's help gets the plugin's
 * pages, panels the button Advise, and Save Data its guard. Without a window (pvpython, pvserver)
 * nothing happens.
 */
void AvianLidarAddToWindow();

#endif
