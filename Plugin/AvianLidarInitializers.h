// SPDX-License-Identifier: BSD-3-Clause
#ifndef AvianLidarInitializers_h
#define AvianLidarInitializers_h

// Functions that ParaView calls when it loads the plugin.

/**
 * Adds the colour presets (Presets/) to the presets of ParaView, unless a preset of the same name
 * exists (a user may have changed it). ParaView keeps added presets among the user's own presets.
 */
void AvianLidarAddColourPresets();

/**
 * Registers three domains for the plugin's XML. A client that has not loaded the plugin may make a
 * proxy from a server's XML, without the domains. If HalfBeamwidth and BeamwidthMilliradians of
 * such a sensor do not agree, the sensor reports an error.
 *
 * AvianLidarBeamsDomain accepts the beams of a sensor.
 *
 * AvianLidarMaterialDomain is a DoubleRangeDomain of a coefficient of a material (attribute
 * coefficient, as for vtkAvianLidarMaterial::GetCoefficientName()). When the required property
 * Material becomes a named material, the panel shows the coefficient of this material.
 *
 * AvianLidarScaledDomain is a DoubleRangeDomain of a property that has the value of the required
 * property Other in another unit: the value of Other times the attribute factor. A change of one
 * property changes the other property.
 */
void AvianLidarAddDomains();

/**
 * Adds the toolbar Avian Lidar to ParaView's window, as soon as there is a window. The toolbar has
 * the echo filter and the macros that are installed beside the plugin. The menu Macros and, in
 * ParaView 5.11, the quick launch (Ctrl+Space) have these macros, too. A click on a macro is one
 * step of Edit > Undo. If the XML of a filter has the hint AvianLidarMenu, menus and quick launch
 * show the text of this hint. ParaView searches only the shown texts. The label of the filter
 * cannot be the text of the hint, because the label gives the name in Python. The first Apply of a
 * source colours echoes and range images by energy, colours points with classes by class, and shows
 * a range image in a view. The function also adds the plugin's help pages, the button Advise and
 * the guard of Save Data. Without a window (pvpython, pvserver) the function does nothing.
 */
void AvianLidarAddToWindow();

#endif
